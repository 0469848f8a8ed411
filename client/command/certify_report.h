// What `linetree bench certify` prints and writes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/audit/cell_study.h"
#include "core/audit/frame_study.h"
#include "core/audit/light_study.h"

namespace linetree {

struct SceneFrames {
  std::string scene;
  std::vector<FrameStudyRow> rows;
};

struct CertifyReport {
  CellStudyOptions cell_options;
  std::vector<CellStudyRow> cells;
  std::string lights_scene;
  std::vector<LightStudyRow> lights;
  std::vector<SceneFrames> frames;

  // Answers that broke a promise, in all parts.
  uint64_t Violations() const;
};

std::string CellTable(const CertifyReport& report);
// Why cells are refused: shares of all cells.
std::string DoubtTable(const CertifyReport& report);
std::string LightTable(const CertifyReport& report);
std::string FrameTable(const CertifyReport& report);
nlohmann::json CertifyJson(const CertifyReport& report);

}  // namespace linetree
