#include "core/store/cell_codec.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace linetree {
namespace {

void Put(const Vec3d& v, ByteWriter& out) {
  out.Put(v.x);
  out.Put(v.y);
  out.Put(v.z);
}

Vec3d GetVec3(ByteReader& in) {
  const double x = in.Get<double>(), y = in.Get<double>(), z = in.Get<double>();
  in.Expect(std::isfinite(x) && std::isfinite(y) && std::isfinite(z));
  return {x, y, z};
}

bool IsObject(const Scene& scene, int32_t object) {
  return object >= 0 && static_cast<size_t>(object) < scene.objects.size();
}

int32_t GetObject(const Scene& scene, ByteReader& in) {
  const auto object = in.Get<int32_t>();
  in.Expect(IsObject(scene, object));
  return object;
}

// What lists consist of: objects, ascending in each list.
std::vector<int32_t> GetObjects(const Scene& scene, ByteReader& in) {
  std::vector<int32_t> objects = in.GetAll<int32_t>();
  in.Expect(std::all_of(objects.begin(), objects.end(),
                        [&](int32_t object) { return IsObject(scene, object); }));
  return objects;
}

// One of the lists that `objects` consists of, of a length that comes next.
std::span<const int32_t> GetList(const std::vector<int32_t>& objects, size_t& begin,
                                 ByteReader& in) {
  const size_t count = in.Get<uint32_t>();
  in.Expect(count <= objects.size() - begin);
  if (!in.ok()) return {};
  const auto list = std::span(objects).subspan(begin, count);
  in.Expect(std::is_sorted(list.begin(), list.end()));
  begin += count;
  return list;
}

void Put(const LightList& list, ByteWriter& out) {
  out.Put(list.knowledge);
  out.Put(list.summed);
  out.Put(list.occluder);
  out.Put(static_cast<uint32_t>(list.candidates.size()));
}

LightList GetLightList(const Scene& scene, const std::vector<int32_t>& objects, size_t& begin,
                       ByteReader& in) {
  LightList list;
  const auto knowledge = in.Get<uint8_t>();
  in.Expect(knowledge <= static_cast<uint8_t>(LightKnowledge::kFacingAway));
  list.knowledge = static_cast<LightKnowledge>(knowledge);
  const auto summed = in.Get<uint8_t>();
  in.Expect(summed <= 1);
  list.summed = summed == 1;
  in.Expect(!list.summed || list.knowledge == LightKnowledge::kOn);
  list.occluder = in.Get<int32_t>();
  in.Expect(list.knowledge == LightKnowledge::kOff ? IsObject(scene, list.occluder)
                                                   : list.occluder == kNoObject);
  list.candidates = GetList(objects, begin, in);
  in.Expect(list.candidates.empty() == (list.knowledge != LightKnowledge::kListed));
  return list;
}

void Put(const ShadowFunction& function, ByteWriter& out) {
  out.Put(function.begin);
  out.Put(function.pieces);
  out.Put(function.squares);
  for (const uint8_t lines : function.lines) out.Put(lines);
}

ShadowFunction GetFunction(size_t coefficients, ByteReader& in) {
  ShadowFunction function;
  function.begin = in.Get<uint32_t>();
  function.pieces = in.Get<uint8_t>();
  function.squares = in.Get<uint8_t>();
  for (uint8_t& lines : function.lines) lines = in.Get<uint8_t>();
  in.Expect(function.pieces <= function.lines.size());
  size_t end = function.begin;
  for (size_t piece = 0; in.ok() && piece < function.pieces; ++piece) {
    end += function.lines[piece] * kLinearSize;
    if ((function.squares >> piece & 1) != 0) end += kQuadraticSize;
  }
  in.Expect(function.pieces == 0 || end <= coefficients);
  return function;
}

void Put(const DiffuseSum* sum, ByteWriter& out) {
  out.Put(static_cast<uint8_t>(sum == nullptr ? 0 : sum->nodes));
  if (sum == nullptr) return;
  out.Put(sum->spread);
  for (int i = 0; i < sum->nodes * sum->nodes; ++i) {
    for (const float value : sum->value[static_cast<size_t>(i)]) out.Put(value);
  }
}

std::unique_ptr<const DiffuseSum> GetSum(ByteReader& in) {
  const int nodes = in.Get<uint8_t>();
  in.Expect(nodes == 0 || nodes == 2 || nodes == 4);
  if (nodes == 0 || !in.ok()) return nullptr;
  auto sum = std::make_unique<DiffuseSum>();
  sum->nodes = nodes;
  sum->spread = in.Get<double>();
  in.Expect(sum->spread >= 0);
  for (int i = 0; i < nodes * nodes; ++i) {
    for (float& value : sum->value[static_cast<size_t>(i)]) value = in.Get<float>();
  }
  return sum;
}

void Put(const PathStep& step, ByteWriter& out) {
  out.Put(step.object);
  out.Put(step.face);
  out.Put(step.side);
  out.Put(step.listed);
  out.Put(step.reflected);
  out.Put(step.transmitted);
  out.Put(static_cast<uint32_t>(step.candidates.size()));
}
// Of a step: what Put writes.
constexpr size_t kStepBytes = 4 * sizeof(int32_t) + 2 + sizeof(uint32_t);

// `following`: steps that come after it.
PathStep GetStep(const Scene& scene, const std::vector<int32_t>& objects, size_t& begin,
                 size_t following, ByteReader& in) {
  PathStep step;
  step.object = in.Get<int32_t>();
  step.face = in.Get<int32_t>();
  const auto side = in.Get<uint8_t>();
  const auto listed = in.Get<uint8_t>();
  in.Expect(step.object == kNoObject || IsObject(scene, step.object));
  in.Expect(side <= 1 && listed <= 1);
  step.side = static_cast<Side>(side);
  step.listed = listed == 1;
  step.reflected = in.Get<int32_t>();
  step.transmitted = in.Get<int32_t>();
  for (const int32_t distance : {step.reflected, step.transmitted}) {
    in.Expect(distance >= 0 && static_cast<size_t>(distance) <= following);
  }
  step.candidates = GetList(objects, begin, in);
  return step;
}

void Put(const Interpolant* interpolant, ByteWriter& out) {
  out.Put(interpolant != nullptr);
  if (interpolant == nullptr) return;
  for (const auto& corner : interpolant->corner) {
    for (const float value : corner) out.Put(value);
  }
}

std::unique_ptr<Interpolant> GetInterpolant(ByteReader& in) {
  const auto has = in.Get<uint8_t>();
  in.Expect(has <= 1);
  if (has == 0 || !in.ok()) return nullptr;
  auto interpolant = std::make_unique<Interpolant>();
  for (auto& corner : interpolant->corner) {
    for (float& value : corner) value = in.Get<float>();
  }
  return interpolant;
}

SurfacePlace GetSurfacePlace(const Scene& scene, ByteReader& in) {
  SurfacePlace place;
  place.object = GetObject(scene, in);
  place.patch = in.Get<int32_t>();
  place.cell.depth = in.Get<uint8_t>();
  place.cell.i = in.Get<uint32_t>();
  place.cell.j = in.Get<uint32_t>();
  in.Expect(place.patch >= 0 && place.cell.depth <= kMaxSurfaceDepth);
  if (in.ok()) {
    in.Expect(place.cell.i >> place.cell.depth == 0 && place.cell.j >> place.cell.depth == 0);
  }
  return place;
}

}  // namespace

void Encode(const SurfacePlace& place, const CellLights& lights, ByteWriter& out) {
  out.Put(place.object);
  out.Put(place.patch);
  out.Put(place.cell.depth);
  out.Put(place.cell.i);
  out.Put(place.cell.j);
  out.PutAll(std::span<const int32_t>(lights.objects));
  for (const LightList& list : lights.lights) Put(list, out);
  out.Put(static_cast<uint32_t>(lights.contacts.size()));
  for (const Contact& contact : lights.contacts) {
    Put(contact.plane.normal, out);
    Put(contact.plane.point, out);
    out.Put(contact.clearance);
  }
  out.PutAll(std::span<const float>(lights.coefficients));
  out.Put(lights.HasFunctions());
  for (const ShadowFunction& function : lights.functions) Put(function, out);
  for (const auto& sum : lights.sums) Put(sum.get(), out);
  out.Put(lights.unsummed);
}

KeptSurfaceCell DecodeSurfaceCell(const Scene& scene, ByteReader& in) {
  KeptSurfaceCell cell;
  cell.place = GetSurfacePlace(scene, in);
  auto lights = std::make_unique<CellLights>();
  lights->objects = GetObjects(scene, in);
  size_t begin = 0;
  for (size_t i = 0; in.ok() && i < scene.lights.size(); ++i) {
    lights->lights.push_back(GetLightList(scene, lights->objects, begin, in));
  }
  in.Expect(begin == lights->objects.size());
  const size_t contacts = in.GetCount(7 * sizeof(double));
  in.Expect(contacts <= kMaxContacts);
  for (size_t i = 0; in.ok() && i < contacts; ++i) {
    Contact contact{};
    contact.plane.normal = GetVec3(in);
    contact.plane.point = GetVec3(in);
    contact.clearance = in.Get<double>();
    in.Expect(contact.clearance >= 0);
    lights->contacts.push_back(contact);
  }
  lights->coefficients = in.GetAll<float>();
  in.Expect(std::all_of(lights->coefficients.begin(), lights->coefficients.end(),
                        [](float c) { return std::isfinite(c); }));
  const auto has_functions = in.Get<uint8_t>();
  in.Expect(has_functions <= 1);
  for (size_t i = 0; in.ok() && has_functions == 1 && i < lights->objects.size(); ++i) {
    lights->functions.push_back(GetFunction(lights->coefficients.size(), in));
  }
  for (auto& sum : lights->sums) sum = GetSum(in);
  lights->unsummed = in.Get<uint32_t>();
  if (!in.ok()) return cell;
  lights->lights.shrink_to_fit();
  lights->contacts.shrink_to_fit();
  lights->functions.shrink_to_fit();
  lights->shadows = {lights->objects.data(), lights->functions.data(), lights->coefficients.data()};
  lights->Weigh();
  lights->MakeTasks(scene);
  cell.lights = std::move(lights);
  return cell;
}

void Encode(const PathPlace& place, const CellPaths& paths, ByteWriter& out) {
  out.Put(place.object);
  out.Put(place.pair);
  out.Put(place.cell.depth);
  for (const uint16_t index : place.cell.index) out.Put(index);
  // Lists were made in another order than steps.
  std::vector<int32_t> objects;
  for (const PathStep& step : paths.steps) {
    objects.insert(objects.end(), step.candidates.begin(), step.candidates.end());
  }
  out.PutAll(std::span<const int32_t>(objects));
  out.Put(static_cast<uint32_t>(paths.steps.size()));
  for (const PathStep& step : paths.steps) Put(step, out);
  out.Put(paths.verdict);
  out.Put(paths.doubt);
  out.Put(paths.spread);
  out.Put(paths.decided);
  Put(paths.interpolant.get(), out);
}

KeptPathCell DecodePathCell(const Scene& scene, ByteReader& in) {
  KeptPathCell kept;
  PathPlace& place = kept.place;
  place.object = GetObject(scene, in);
  place.pair = in.Get<int32_t>();
  place.cell.depth = in.Get<uint8_t>();
  for (uint16_t& index : place.cell.index) index = in.Get<uint16_t>();
  in.Expect(place.pair >= 0 && place.cell.depth <= kMaxCellDepth);
  for (const uint16_t index : place.cell.index) {
    if (in.ok()) in.Expect(index >> place.cell.depth == 0);
  }
  auto paths = std::make_unique<CellPaths>();
  paths->objects = GetObjects(scene, in);
  const size_t steps = in.GetCount(kStepBytes);
  size_t begin = 0;
  for (size_t i = 0; in.ok() && i < steps; ++i) {
    paths->steps.push_back(GetStep(scene, paths->objects, begin, steps - 1 - i, in));
  }
  in.Expect(begin == paths->objects.size());
  const auto verdict = in.Get<uint8_t>();
  const auto doubt = in.Get<uint8_t>();
  in.Expect(verdict < kVerdictCount && doubt < kDoubtCount);
  paths->verdict = static_cast<Verdict>(verdict);
  paths->doubt = static_cast<Doubt>(doubt);
  paths->spread = in.Get<double>();
  in.Expect(paths->spread >= 0);
  paths->decided = in.Get<uint8_t>() == 1;
  paths->interpolant = GetInterpolant(in);
  // Who is certified has an interpolant, and a first step.
  in.Expect((paths->verdict == Verdict::kCertified) <=
            (paths->interpolant != nullptr && !paths->steps.empty()));
  if (!in.ok()) return kept;
  paths->steps.shrink_to_fit();
  kept.paths = std::move(paths);
  return kept;
}

}  // namespace linetree
