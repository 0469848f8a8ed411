#include "core/audit/cell_study.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/audit/clock.h"
#include "core/audit/random_stream.h"
#include "core/certify/path_certifier.h"
#include "core/tree/corner_sample.h"
#include "core/tree/paper_judge.h"

namespace linetree {
namespace {

// One list of steps, for the first surface of one ray.
class OneList : public PathLists {
 public:
  explicit OneList(const PathStep* steps) : steps_(steps) {}
  const PathStep* Find(const Hit&, const Vec3d&) const override {
    return std::exchange(steps_, nullptr);
  }

 private:
  mutable const PathStep* steps_;
};
class NoLists : public LightLists {
 public:
  KnownLights Find(const Hit&) const override { return {}; }
};

struct RandomCell {
  int object = 0;
  int pair = 0;
  CellBox box;
};

class SceneStudy {
 public:
  SceneStudy(const CellStudyOptions& options, SparseFamily family, uint64_t seed)
      : options_(options),
        random_(MixBits(seed)),
        samples_(MixBits(~seed)),
        scene_(MakeSparseScene(family, seed)),
        tracer_(*scene_),
        certifier_(tracer_),
        paper_(tracer_) {
    for (const Object& object : scene_->objects) charts_.emplace_back(object);
    limits_.max_depth = options.max_depth;
  }

  CellStudyRow Study(double edge) {
    CellStudyRow row;
    row.edge = edge;
    row.certified.resize(options_.epsilons.size());
    row.paper.resize(options_.epsilons.size());
    row.sampled.resize(options_.epsilons.size());
    row.sampled_isotopic.resize(options_.epsilons.size());
    for (int i = 0; i < options_.cells_per_scene; ++i) {
      if (const auto cell = SomeCell(edge)) StudyCell(*cell, row);
    }
    return row;
  }

 private:
  // The cell, on a grid of the given edge, of a random ray that meets a random object.
  std::optional<RandomCell> SomeCell(double edge) {
    RandomCell cell;
    cell.object = random_.Below(static_cast<int>(scene_->objects.size()));
    const ObjectChart& chart = charts_[static_cast<size_t>(cell.object)];
    const Box3& bounds = scene_->objects[static_cast<size_t>(cell.object)].bounds;
    const double reach = std::max(0.25, Length(bounds.Extent()) / 2);
    Vec3d eye = bounds.Center() + random_.Direction() * (random_.Uniform(1.5, 4) * reach);
    if (eye.z < -0.9) eye.z = random_.Uniform(-0.9, 1.1);
    const Vec3d direction = Normalized(random_.InBox(bounds.min, bounds.max) - eye);
    const Hit hit = tracer_.IntersectObjectLine(cell.object, eye, direction);
    if (!hit.IsHit() || hit.t < 0) return std::nullopt;
    cell.pair = chart.PairOf(direction);
    const auto coords = chart.CoordsOf(cell.pair, hit.point, direction);
    if (!coords) return std::nullopt;
    const RayCoords size = EdgesOf(chart.FormOf(cell.pair), edge);
    for (size_t i = 0; i < 4; ++i) {
      const double index = std::floor((*coords)[i] / size[i]);
      cell.box.from[i] = index * size[i];
      cell.box.to[i] = std::min(1.0, (index + 1) * size[i]);
    }
    return cell;
  }

  // A part of the box's faces in coordinates, whose planes are larger. Slopes on planar objects run
  // over twice the width that rays through a box of a quarter of the object's size have.
  static RayCoords EdgesOf(const LineForm& form, double edge) {
    if (!form.between_planes) return {edge, edge, 2 * edge, 2 * edge};
    RayCoords size;
    for (size_t i = 0; i < 2; ++i) {
      const double half = Length(form.origin_by[i]) / 2;
      size[i] = size[i + 2] = edge * (half - form.along_axis) / half;
    }
    return size;
  }

  void StudyCell(const RandomCell& cell, CellStudyRow& row) {
    ++row.cells;
    const ObjectChart& chart = charts_[static_cast<size_t>(cell.object)];
    const double begin = ThreadUs();
    const CellPaths paths =
        certifier_.Certify(cell.object, chart, cell.pair, cell.box, limits_, nullptr);
    const double took = ThreadUs() - begin;
    const bool same = paths.verdict == Verdict::kCertified;
    const bool partly = !same && paths.ListsAnything();
    (same ? row.accepted_us : partly ? row.partly_us : row.refused_us) += took;
    row.same_paths += same ? 1 : 0;
    row.partly += partly ? 1 : 0;
    if (same) row.same_path_rays += paths.steps.size();
    if (partly) row.partly_rays += paths.steps.size();
    if (!same) ++row.doubts[static_cast<size_t>(paths.doubt)];
    const double before_shades = ThreadUs();
    const Corners corners = Shade(cell);
    if (same) row.shades_us += ThreadUs() - before_shades;
    const bool isotopic = LooksIsotopic(cell, corners);
    if (isotopic) {
      ++row.isotopic;
      if (!same) ++row.isotopic_doubts[static_cast<size_t>(paths.doubt)];
    }
    const Judgement paper = paper_.Decide(corners);
    const double sampled = SampledError(cell, corners, paths);
    for (size_t i = 0; i < options_.epsilons.size(); ++i) {
      const double epsilon = options_.epsilons[i];
      row.certified[i] += same && paths.spread <= epsilon ? 1 : 0;
      row.paper[i] += paper.verdict == Verdict::kCertified && paper.spread <= epsilon ? 1 : 0;
      row.sampled[i] += sampled <= epsilon ? 1 : 0;
      row.sampled_isotopic[i] += isotopic && sampled <= epsilon ? 1 : 0;
    }
    for (int q = 0; q < options_.queries_per_cell; ++q) Query(cell, paths, row);
  }

  Corners Shade(const RandomCell& cell) {
    Corners corners;
    RayCounts counts;
    for (size_t m = 0; m < kCellCorners; ++m) {
      RayCoords at;
      for (size_t i = 0; i < 4; ++i) at[i] = (m >> i & 1) != 0 ? cell.box.to[i] : cell.box.from[i];
      corners[m] = std::make_shared<const CornerSample>(
          TraceCorner(tracer_, cell.object, charts_[static_cast<size_t>(cell.object)], cell.pair,
                      at, limits_, counts));
    }
    return corners;
  }

  // Of a ray in the cell: sides and middles are as likely as the rest.
  static RayCoords SomeLocal(RandomStream& random) {
    RayCoords local;
    for (double& x : local) x = random.OneIn(4) ? 0.5 * random.Below(3) : random.Unit();
    return local;
  }
  static RayCoords In(const CellBox& box, const RayCoords& local) {
    RayCoords at;
    for (size_t i = 0; i < 4; ++i) at[i] = box.from[i] + local[i] * (box.to[i] - box.from[i]);
    return at;
  }

  bool LooksIsotopic(const RandomCell& cell, const Corners& corners) {
    const auto is_like_first = [&](const CornerSample& sample) {
      return sample.hits && SameTopology(sample.tree, corners[0]->tree);
    };
    if (!std::all_of(corners.begin(), corners.end(),
                     [&](const auto& corner) { return is_like_first(*corner); })) {
      return false;
    }
    const ObjectChart& chart = charts_[static_cast<size_t>(cell.object)];
    RayCounts counts;
    for (int q = 0; q < options_.queries_per_cell; ++q) {
      const RayCoords at = In(cell.box, SomeLocal(random_));
      if (!is_like_first(
              TraceCorner(tracer_, cell.object, chart, cell.pair, at, limits_, counts))) {
        return false;
      }
    }
    return true;
  }

  // Relative, the largest of three channels, as the promise has it.
  double ErrorOf(const Rgb& answer, const Rgb& classical) const {
    double error = 0;
    for (int c = 0; c < 3; ++c) {
      const double floor = std::max(classical[c], RadianceFloor(*scene_));
      error = std::max(error, std::abs(answer[c] - classical[c]) / floor);
    }
    return error;
  }

  // The largest error in sampled rays of the better one of two interpolants: of the corners, and
  // the certified one, which is moved to the middle of its errors. Infinity where some ray misses
  // the object or both are beyond every epsilon.
  double SampledError(const RandomCell& cell, const Corners& corners, const CellPaths& paths) {
    if (!std::all_of(corners.begin(), corners.end(), [](const auto& c) { return c->hits; })) {
      return Box3::kInf;
    }
    Interpolant between{};
    for (size_t m = 0; m < kCellCorners; ++m) {
      const Rgb radiance = corners[m]->tree.radiance;
      for (int c = 0; c < 3; ++c) {
        between.corner[m][static_cast<size_t>(c)] = static_cast<float>(radiance[c]);
      }
    }
    const double most = options_.epsilons.empty() ? 0 : options_.epsilons.back();
    double error = 0, certified = paths.interpolant ? 0 : Box3::kInf;
    const ObjectChart& chart = charts_[static_cast<size_t>(cell.object)];
    RayCounts counts;
    for (int q = 0; q < options_.samples_per_cell; ++q) {
      const RayCoords local = SomeLocal(samples_);
      const Ray line = chart.LineOf(cell.pair, In(cell.box, local));
      const Hit hit = tracer_.IntersectObjectLine(cell.object, line.origin, line.direction);
      if (!hit.IsHit()) return Box3::kInf;
      const Rgb classical =
          tracer_.RadianceFromHit(hit, line.origin, line.direction, limits_, counts);
      error = std::max(error, ErrorOf(Evaluate(between, local), classical));
      if (paths.interpolant) {
        certified = std::max(certified, ErrorOf(Evaluate(*paths.interpolant, local), classical));
      }
      if (std::min(error, certified) > most) return Box3::kInf;
    }
    return std::min(error, certified);
  }

  void Query(const RandomCell& cell, const CellPaths& paths, CellStudyRow& row) {
    if (paths.steps.empty()) return;
    const RayCoords local = SomeLocal(random_);
    const RayCoords at = In(cell.box, local);
    const Ray line = charts_[static_cast<size_t>(cell.object)].LineOf(cell.pair, at);
    const Hit hit = tracer_.IntersectObjectLine(cell.object, line.origin, line.direction);
    if (!hit.IsHit() || !paths.steps[0].EndsAt(hit)) return;
    RayCounts counts;
    const Rgb classical =
        tracer_.RadianceFromHit(hit, line.origin, line.direction, limits_, counts);
    const OneList list(paths.steps.data());
    const Rgb replayed = tracer_.RadianceFromHit(hit, line.origin, line.direction, limits_,
                                                 NoLists(), &list, counts);
    if (!(replayed == classical)) ++row.replay_differences;
    if (paths.verdict != Verdict::kCertified) return;
    ++row.queries;
    const double error = ErrorOf(Evaluate(*paths.interpolant, local), classical);
    if (error > paths.spread) ++row.violations;
    if (paths.spread > 0) row.largest_error = std::max(row.largest_error, error / paths.spread);
  }

  const CellStudyOptions& options_;
  RandomStream random_;
  RandomStream samples_;  // of its own: what is sampled changes nothing else
  const std::shared_ptr<const Scene> scene_;
  const Tracer tracer_;
  const PathCertifier certifier_;
  const PaperJudge paper_;
  std::vector<ObjectChart> charts_;
  PathLimits limits_;
};

void Add(const CellStudyRow& from, CellStudyRow& to) {
  to.cells += from.cells;
  to.same_paths += from.same_paths;
  to.partly += from.partly;
  for (size_t i = 0; i < from.certified.size(); ++i) {
    to.certified[i] += from.certified[i];
    to.paper[i] += from.paper[i];
    to.sampled[i] += from.sampled[i];
    to.sampled_isotopic[i] += from.sampled_isotopic[i];
  }
  for (size_t i = 0; i < from.doubts.size(); ++i) {
    to.doubts[i] += from.doubts[i];
    to.isotopic_doubts[i] += from.isotopic_doubts[i];
  }
  to.isotopic += from.isotopic;
  to.queries += from.queries;
  to.violations += from.violations;
  to.replay_differences += from.replay_differences;
  to.largest_error = std::max(to.largest_error, from.largest_error);
  to.same_path_rays += from.same_path_rays;
  to.partly_rays += from.partly_rays;
  to.accepted_us += from.accepted_us;
  to.partly_us += from.partly_us;
  to.refused_us += from.refused_us;
  to.shades_us += from.shades_us;
}

CellStudyRow StudyCells(const CellStudyOptions& options, SparseFamily family, double edge,
                        WorkerPool& pool) {
  std::vector<CellStudyRow> parts(static_cast<size_t>(options.scenes));
  pool.ParallelFor(parts.size(), [&](size_t i) {
    parts[i] = SceneStudy(options, family, options.seed * 1'000'003 + i).Study(edge);
  });
  CellStudyRow row = parts[0];
  row.family = family;
  for (size_t i = 1; i < parts.size(); ++i) Add(parts[i], row);
  const double accepted = std::max<double>(1, static_cast<double>(row.same_paths));
  row.accepted_us /= accepted;
  row.shades_us /= accepted;
  row.partly_us /= std::max<double>(1, static_cast<double>(row.partly));
  row.refused_us /=
      std::max<double>(1, static_cast<double>(row.cells - row.same_paths - row.partly));
  return row;
}

}  // namespace

std::vector<CellStudyRow> StudyCells(const CellStudyOptions& options, WorkerPool& pool,
                                     const std::function<void(double)>& progress) {
  std::vector<CellStudyRow> rows;
  const size_t count = options.families.size() * options.edges.size();
  for (const SparseFamily family : options.families) {
    for (const double edge : options.edges) {
      rows.push_back(StudyCells(options, family, edge, pool));
      progress(static_cast<double>(rows.size()) / static_cast<double>(count));
    }
  }
  return rows;
}

}  // namespace linetree
