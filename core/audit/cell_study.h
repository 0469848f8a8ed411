// How many random 4D cells the two judges accept, what that costs, and whether it is true.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/audit/sparse_scene.h"
#include "core/certify/cell_paths.h"
#include "core/render/worker_pool.h"

namespace linetree {

struct CellStudyOptions {
  uint64_t seed = 1;
  std::vector<SparseFamily> families = {SparseFamily::kEven, SparseFamily::kOpaque};
  int scenes = 100;  // of each family
  int cells_per_scene = 60;
  int queries_per_cell = 40;
  int samples_per_cell = 256;
  // Edges of cells as parts of the faces of the object's bounding box.
  std::vector<double> edges = {0.25, 0.125, 0.0625, 0.03125, 0.015625};
  std::vector<double> epsilons = {0.02, 0.1, 0.25};
  int max_depth = 6;
};

// All cells of one edge in the scenes of one family.
struct CellStudyRow {
  SparseFamily family = SparseFamily::kEven;
  double edge = 0;
  uint64_t cells = 0;                      // whose middle ray was aimed at an object
  uint64_t partly = 0;                     // others that save some search all the same
  uint64_t same_paths = 0;                 // all rays certainly meet the same surfaces and lights
  std::vector<uint64_t> certified, paper;  // accepted, by epsilon
  // Cells in whose sampled rays an interpolant keeps within epsilon: what a proof could accept at
  // most, whatever it knew; and how many of them look isotopic.
  std::vector<uint64_t> sampled, sampled_isotopic;
  // The others, by the first reason why not all rays certainly take the same path.
  std::array<uint64_t, kDoubtCount> doubts{};
  // Cells whose corners and `queries_per_cell` more rays have isomorphic ray trees: what a judge
  // could accept at most, and of these the others again.
  uint64_t isotopic = 0;
  std::array<uint64_t, kDoubtCount> isotopic_doubts{};
  uint64_t queries = 0;             // rays inside certified cells
  uint64_t violations = 0;          // whose error is beyond the cell's bound
  uint64_t replay_differences = 0;  // answers along the cell's lists that differ by a bit
  double largest_error = 0;         // relative to the bound
  // Rays of a path that were followed, the first one included, in the cells of both kinds.
  uint64_t same_path_rays = 0, partly_rays = 0;
  // Microseconds of processor time for a cell: certified ones, those that are partly known, those
  // of which nothing is, and sixteen classical shades of the certified ones' corners.
  double accepted_us = 0, partly_us = 0, refused_us = 0, shades_us = 0;
};

// By family, then edge.
std::vector<CellStudyRow> StudyCells(const CellStudyOptions& options, WorkerPool& pool,
                                     const std::function<void(double)>& progress);

}  // namespace linetree
