#include "client/command/command.h"

#include <algorithm>
#include <iostream>
#include <numeric>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"

namespace linetree {
namespace {

// Levenshtein's distance.
size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

// The deepest sub-command that was given.
const CLI::App& Deepest(const CLI::App& app) {
  const auto given = app.get_subcommands();
  return given.empty() ? app : Deepest(*given.front());
}

std::vector<std::string> Known(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  for (const CLI::App* sub : app.get_subcommands({})) names.push_back(sub->get_name());
  return names;
}

// What may have been meant by a word that was not expected: a name at most two typing errors, and
// less than half of its length, away.
std::optional<std::string> Meant(const CLI::App& app, const std::string& word) {
  std::optional<std::string> best;
  size_t best_distance = 3;
  for (const std::string& name : Known(app)) {
    const size_t distance = EditDistance(word, name);
    if (distance < best_distance && 2 * distance < word.size()) {
      best = name;
      best_distance = distance;
    }
  }
  return best;
}

std::string Hint(const CLI::App& root) {
  const CLI::App& app = Deepest(root);
  std::string hint;
  const std::vector<std::string> extras = root.remaining(true);
  if (!extras.empty()) {
    if (const auto meant = Meant(app, extras.front())) {
      absl::StrAppend(&hint, "; did you mean ", *meant, "?");
    }
  }
  std::string command;
  for (const CLI::App* a = &app; a != nullptr; a = a->get_parent()) {
    command = absl::StrCat(a->get_name(), command.empty() ? "" : " ", command);
  }
  absl::StrAppend(&hint, "; see '", command, " --help'");
  return hint;
}

// CLI11 complains of what is missing before it complains of what is unknown; a mistyped word is
// likelier to be the cause of both.
int UsageError(const CLI::App& root, const CLI::ParseError& error) {
  const std::vector<std::string> extras = root.remaining(true);
  const bool missing = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr ||
                       dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  const std::string what = missing && !extras.empty()
                               ? absl::StrCat("unknown argument '", extras.front(), "'")
                               : error.what();
  return Report(absl::InvalidArgumentError(absl::StrCat(what, Hint(root))), kExitUsage);
}

}  // namespace

int Report(const absl::Status& status, int exit_status) {
  const std::string text = absl::StrReplaceAll(status.message(), {{"\r", ""}, {"\n", "; "}});
  std::cout.flush();
  std::cerr << "linetree: " << (text.empty() ? status.ToString() : text) << '\n';
  return exit_status;
}

int RunCommandLine(int argc, const char* const* argv) {
  CLI::App app("Ray tracing with a cache of radiance that is bounded in error: client and tools.",
               "linetree");
  app.require_subcommand(1);
  app.set_version_flag("--version", "linetree " LINETREE_VERSION);
  app.footer(
      "'linetree COMMAND --help' explains a command and shows examples.\n"
      "Exit status: 0 done, 1 failed (or the answer is no), 2 wrong usage.");
  Commands commands;
  AddRender(app, commands);
  AddFly(app, commands);
  AddRays(app, commands);
  AddStats(app, commands);
  AddScene(app, commands);
  AddCompare(app, commands);
  AddStore(app, commands);
  AddLoad(app, commands);
  AddCache(app, commands);
  AddBench(app, commands);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked_for_help) {
    return app.exit(asked_for_help);
  } catch (const CLI::ParseError& error) {
    return UsageError(app, error);
  }
  const CLI::App& chosen = Deepest(app);
  for (const Command& command : commands) {
    if (command.app != &chosen) continue;
    const absl::StatusOr<int> result = command.run();
    return result.ok() ? *result : Report(result.status());
  }
  return Report(absl::InternalError(absl::StrCat("no command ", chosen.get_name())));
}

}  // namespace linetree
