// linetree store: what a server keeps on its disk.
#include <chrono>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "client/command/command.h"
#include "client/command/output.h"
#include "client/command/table.h"
#include "core/store/cell_store.h"
#include "core/store/data_folder.h"
#include "core/store/page.h"

namespace linetree {
namespace {

struct StoreFlags {
  std::string data_folder = DefaultDataFolder();
  std::string stats;  // file for JSON
  // Of prune:
  std::vector<std::string> scenes;
  double older_than_days = -1;
  bool others = false;
  bool all = false;
  uint64_t store_bytes = uint64_t{1} << 30;
};

// What is kept of one scene.
struct SceneSum {
  std::string name;
  int64_t last_used = 0;
  uint64_t pages = 0;
  uint64_t bytes = 0;
  uint64_t surface_cells = 0;
  uint64_t path_cells = 0;
  uint64_t other_pages = 0;  // of other programs
  uint64_t odd_pages = 0;
};
using SceneSums = std::map<SceneVersion, SceneSum>;

// Nothing where the page is odd, or not that of its key.
std::optional<PageHead> HeadOf(const PageKey& key, std::string_view bytes) {
  const auto page = OpenPage(bytes);
  if (!page || page->head.scene != key.scene || page->head.algorithm != key.algorithm ||
      page->head.number != key.number) {
    return std::nullopt;
  }
  return page->head;
}

absl::StatusOr<std::unique_ptr<PageFile>> OpenFile(const StoreFlags& flags,
                                                   PageFile::Access access) {
  if (flags.data_folder.empty()) {
    return absl::InvalidArgumentError("--data-dir: expected a folder; $HOME is not set");
  }
  return PageFile::Open(CellFolder(flags.data_folder), flags.store_bytes, access);
}

absl::StatusOr<SceneSums> Sum(const PageFile& file) {
  SceneSums sums;
  const auto status = file.ForEach([&](const PageKey& key, std::string_view bytes) {
    SceneSum& sum = sums[key.scene];
    ++sum.pages;
    sum.bytes += bytes.size();
    const auto head = HeadOf(key, bytes);
    if (!head) {
      ++sum.odd_pages;
      return;
    }
    (head->kind == PageKind::kSurface ? sum.surface_cells : sum.path_cells) += head->cells;
    if (head->algorithm != CellStore::Algorithm()) ++sum.other_pages;
  });
  if (!status.ok()) return status;
  const auto notes = file.Notes();
  if (!notes.ok()) return notes.status();
  for (const SceneNote& note : *notes) {
    if (!sums.contains(note.scene)) continue;
    sums[note.scene].name = note.name;
    sums[note.scene].last_used = note.last_used;
  }
  return sums;
}

std::string When(int64_t seconds) {
  return seconds == 0 ? ""
                      : absl::FormatTime("%Y-%m-%d %H:%M", absl::FromUnixSeconds(seconds),
                                         absl::LocalTimeZone());
}

absl::StatusOr<int> Stat(const StoreFlags& flags) {
  const auto file = OpenFile(flags, PageFile::Access::kReadOnly);
  if (!file.ok()) return file.status();
  const auto sums = Sum(**file);
  if (!sums.ok()) return sums.status();
  Table table({{"scene"},
               {"version"},
               {"last used"},
               {"pages", Align::kRight},
               {"of other programs", Align::kRight},
               {"surface cells", Align::kRight},
               {"linetree cells", Align::kRight},
               {"bytes", Align::kRight}});
  nlohmann::json scenes = nlohmann::json::array();
  for (const auto& [version, sum] : *sums) {
    table.AddRow({sum.name, version, When(sum.last_used), Grouped(sum.pages),
                  Grouped(sum.other_pages), Grouped(sum.surface_cells), Grouped(sum.path_cells),
                  Grouped(sum.bytes)});
    scenes.push_back({{"name", sum.name},
                      {"version", version},
                      {"last_used", sum.last_used},
                      {"pages", sum.pages},
                      {"pages_of_other_programs", sum.other_pages},
                      {"pages_odd", sum.odd_pages},
                      {"surface_cells", sum.surface_cells},
                      {"linetree_cells", sum.path_cells},
                      {"bytes", sum.bytes}});
  }
  const PageFile::Sizes sizes = (*file)->SizesNow();
  if (!flags.stats.empty()) {
    auto status = WriteJson({{"folder", (*file)->folder()},
                             {"file_bytes", sizes.file_bytes},
                             {"used_bytes", sizes.used_bytes},
                             {"scenes", std::move(scenes)}},
                            flags.stats);
    if (!status.ok()) return status;
  }
  std::cout << table.ToString() << (*file)->folder() << ": " << Bytes(sizes.used_bytes) << " of "
            << Bytes(sizes.file_bytes) << " in use\n";
  return kExitOk;
}

absl::StatusOr<int> Verify(const StoreFlags& flags) {
  const auto file = OpenFile(flags, PageFile::Access::kReadOnly);
  if (!file.ok()) return file.status();
  uint64_t pages = 0, odd = 0;
  const auto status = (*file)->ForEach([&](const PageKey& key, std::string_view bytes) {
    ++pages;
    if (HeadOf(key, bytes)) return;
    ++odd;
    std::cout << "page " << key.number << " of scene " << key.scene
              << ": expected the checksum and head that it was sealed with\n";
  });
  if (!status.ok()) return status;
  std::cout << Grouped(pages) << " pages, " << Grouped(odd) << " odd\n";
  return odd == 0 ? kExitOk : kExitFailure;
}

absl::StatusOr<int> Prune(const StoreFlags& flags) {
  const auto file = OpenFile(flags, PageFile::Access::kWrite);
  if (!file.ok()) return file.status();
  const auto sums = Sum(**file);
  if (!sums.ok()) return sums.status();
  for (const std::string& scene : flags.scenes) {
    const bool is_there = std::any_of(sums->begin(), sums->end(), [&](const auto& sum) {
      return sum.first == scene || sum.second.name == scene;
    });
    if (!is_there) {
      return absl::NotFoundError(absl::StrCat(
          "--scene: expected the name or version of a scene that is kept, got '", scene, "'"));
    }
  }
  const double oldest =
      static_cast<double>(absl::ToUnixSeconds(absl::Now())) - flags.older_than_days * 24 * 60 * 60;
  const auto goes = [&](const PageKey& key, std::string_view bytes) {
    if (flags.all || !HeadOf(key, bytes)) return true;
    if (flags.others && key.algorithm != CellStore::Algorithm()) return true;
    const SceneSum& sum = sums->at(key.scene);
    if (flags.older_than_days >= 0 && static_cast<double>(sum.last_used) < oldest) return true;
    return std::any_of(flags.scenes.begin(), flags.scenes.end(), [&](const std::string& scene) {
      return scene == key.scene || scene == sum.name;
    });
  };
  const auto erased = (*file)->Erase(goes);
  if (!erased.ok()) return erased.status();
  std::cout << Grouped(*erased) << " pages taken out\n";
  return kExitOk;
}

void AddFolderFlag(CLI::App& app, StoreFlags& flags) {
  app.add_option("--data-dir", flags.data_folder, "The server's")
      ->type_name("FOLDER")
      ->capture_default_str();
}

void AddPruneFlags(CLI::App& app, StoreFlags& flags) {
  AddFolderFlag(app, flags);
  app.add_option("--scene", flags.scenes, "Scenes of this name or version; may be repeated")
      ->type_name("NAME");
  app.add_option("--older-than", flags.older_than_days, "Scenes not loaded for so many days")
      ->type_name("DAYS")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--others", flags.others, "What other versions of the program have kept");
  app.add_flag("--all", flags.all, "Everything");
  app.add_option("--store-bytes", flags.store_bytes, "As for linetreed")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/true))
      ->default_str("1GiB");
  app.footer(
      "Pages that are not as they were written go in any case. No server may run on the folder; "
      "what is taken out makes room in the file, which does not become smaller.\n\n"
      "Example:\n"
      "  linetree store prune --others --older-than 30");
}

}  // namespace

void AddStore(CLI::App& parent, Commands& commands) {
  auto flags = std::make_shared<StoreFlags>();
  CLI::App* store =
      parent.add_subcommand("store", "What a server keeps on its disk: stat, verify, prune");
  store->require_subcommand(1);
  CLI::App* stat = store->add_subcommand("stat", "What is kept, scene by scene");
  AddFolderFlag(*stat, *flags);
  stat->add_option("--stats", flags->stats, "Also write it as JSON")->type_name("FILE");
  commands.push_back({stat, [flags] { return Stat(*flags); }});
  CLI::App* verify = store->add_subcommand(
      "verify", "Read every page and compare its checksum; exits with 1 if one is odd");
  AddFolderFlag(*verify, *flags);
  commands.push_back({verify, [flags] { return Verify(*flags); }});
  CLI::App* prune = store->add_subcommand("prune", "Take pages out");
  AddPruneFlags(*prune, *flags);
  commands.push_back({prune, [flags] { return Prune(*flags); }});
}

}  // namespace linetree
