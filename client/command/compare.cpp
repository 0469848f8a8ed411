// linetree compare: how far one picture is from another.
#include "core/io/compare.h"

#include <iostream>
#include <memory>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/command.h"
#include "client/command/table.h"
#include "core/io/exr.h"

namespace linetree {
namespace {

struct CompareFlags {
  std::string picture;
  std::string reference;
  std::optional<double> epsilon;
  std::optional<double> white;
  std::optional<double> floor;
  bool json = false;
};

void Print(const ErrorFigures& figures, const CompareOptions& options, int width) {
  const auto columns = static_cast<uint64_t>(width);
  std::cout << absl::StrFormat("pixels           %s\n", Grouped(figures.pixels))
            << absl::StrFormat("max error        %.6g at pixel (%d, %d)\n", figures.max,
                               figures.worst % columns, figures.worst / columns)
            << absl::StrFormat("99.9 percentile  %.6g\n", figures.p999)
            << absl::StrFormat("mean error       %.6g\n", figures.mean)
            << absl::StrFormat("PSNR             %.2f dB\n", figures.psnr_db)
            << absl::StrFormat("beyond %-9.4g %s", options.max_relative_error,
                               Grouped(figures.beyond));
  if (figures.not_finite > 0) {
    std::cout << absl::StrFormat(" (%s not finite)", Grouped(figures.not_finite));
  }
  std::cout << '\n';
}

absl::StatusOr<int> Compare(const CompareFlags& flags) {
  const absl::StatusOr<Frame> picture = ReadExr(flags.picture);
  if (!picture.ok()) return Report(picture.status(), kExitUsage);
  const absl::StatusOr<Frame> reference = ReadExr(flags.reference);
  if (!reference.ok()) return Report(reference.status(), kExitUsage);

  CompareOptions options;
  options.white = flags.white.value_or(reference->white);
  options.floor = flags.floor.value_or(options.white * kFloorOfWhite);
  options.max_relative_error = flags.epsilon.value_or(picture->max_relative_error);
  const absl::StatusOr<ErrorFigures> figures = CompareFrames(*picture, *reference, options);
  if (!figures.ok()) return Report(figures.status(), kExitUsage);
  if (flags.json) {
    std::cout << ErrorJson(*figures, options, picture->width).dump(2) << '\n';
  } else {
    Print(*figures, options, picture->width);
  }
  return figures->beyond > 0 ? kExitFailure : kExitOk;
}

}  // namespace

void AddCompare(CLI::App& parent, Commands& commands) {
  auto flags = std::make_shared<CompareFlags>();
  CLI::App* app = parent.add_subcommand("compare", "Measure a picture against a reference");
  app->add_option("A", flags->picture, "Picture, .exr")->required();
  app->add_option("B", flags->reference, "Reference, .exr")->required();
  app->add_option("--epsilon", flags->epsilon,
                  "Largest relative error that is allowed; left out: what A promises")
      ->type_name("E")
      ->check(CLI::NonNegativeNumber);
  app->add_option("--white", flags->white, "Left out: the reference's attribute, or 1")
      ->type_name("L")
      ->check(CLI::PositiveNumber);
  app->add_option("--floor", flags->floor,
                  "Radiance below which errors are no longer relative; left out: white / 1024")
      ->type_name("L")
      ->check(CLI::PositiveNumber);
  app->add_flag("--json", flags->json, "The figures as JSON");
  app->footer(
      "A pixel's error is the largest of its channels' |a - b| / max(|b|, floor), infinite where a "
      "or "
      "b is\nnot finite. PSNR is relative to white.\n"
      "Exit status: 0 if no pixel is beyond E, 1 if any is, 2 if the pictures cannot be "
      "compared.\n\n"
      "Examples:\n"
      "  linetree compare cached.exr classical.exr\n"
      "  linetree compare cached.exr classical.exr --epsilon 0.05 --json");
  commands.push_back({app, [flags] { return Compare(*flags); }});
}

}  // namespace linetree
