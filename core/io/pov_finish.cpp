#include "core/io/pov_finish.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace linetree {
namespace {

// How well a colour must be met, relative to its brightest channel: a few roundings.
constexpr double kColorTolerance = 1e-12;

// Stands for the exponent 0.
constexpr double kMaxRoughness = 1e30;

bool IsGrey(const Rgb& c) { return c.r == c.g && c.g == c.b; }

struct Film {
  Rgb color;
  double filter = 0, transmit = 0;
};

// C, F and T with C * F + T = kt and C proportional to kd. A grey kt needs no filter. Otherwise kt
// - T must be proportional to kd, which the two channels in which kt differs most decide.
std::optional<Film> FilmFor(const Rgb& kd, const Rgb& kt) {
  Film film;
  const double brightest = MaxChannel(kd);
  film.color = brightest > 0 ? Scaled(kd, 1 / brightest) : Rgb{1, 1, 1};
  if (IsGrey(kt)) {
    film.transmit = kt.r;
    return film;
  }
  if (brightest == 0) {
    film.filter = MaxChannel(kt);
    film.color = Scaled(kt, 1 / film.filter);
    return film;
  }
  int i = 0, j = 0;
  for (int k = 1; k < 3; ++k) {
    if (kt[k] > kt[i]) i = k;
    if (kt[k] < kt[j]) j = k;
  }
  const double slope = film.color[i] - film.color[j];
  if (!(slope > 0)) return std::nullopt;
  film.filter = (kt[i] - kt[j]) / slope;
  film.transmit = kt[i] - film.filter * film.color[i];
  if (std::abs(film.transmit) <= kColorTolerance) film.transmit = 0;
  for (int k = 0; k < 3; ++k) {
    const double met = film.color[k] * film.filter + film.transmit;
    if (std::abs(met - kt[k]) > kColorTolerance) return std::nullopt;
  }
  if (film.transmit < 0) return std::nullopt;
  return film;
}

}  // namespace

absl::StatusOr<PovFinish> ToPovFinish(const Material& material) {
  if (!IsGrey(material.specular)) return absl::UnimplementedError("coloured specular");
  const auto film = FilmFor(material.diffuse, material.transmit);
  if (!film) return absl::UnimplementedError("transmit of another colour than diffuse");

  PovFinish finish;
  finish.color = film->color;
  finish.filter = film->filter;
  finish.transmit = film->transmit;
  const double opacity = 1 - film->filter - film->transmit;
  const bool is_clear = IsBlack(material.diffuse) && IsBlack(material.ambient);
  if (!is_clear && !(opacity > kColorTolerance)) {
    return absl::UnimplementedError("diffuse or ambient on a surface that transmits everything");
  }
  if (!is_clear) finish.diffuse = MaxChannel(material.diffuse) / opacity;
  for (int k = 0; k < 3; ++k) {
    if (material.ambient[k] == 0) continue;
    if (film->color[k] == 0) {
      return absl::UnimplementedError("ambient in a channel in which diffuse or transmit is 0");
    }
    finish.ambient[k] = material.ambient[k] / (film->color[k] * opacity);
  }
  finish.specular = material.specular.r;
  finish.roughness = material.exponent > 1 / kMaxRoughness ? 1 / material.exponent : kMaxRoughness;
  finish.reflection = material.reflect;
  return finish;
}

}  // namespace linetree
