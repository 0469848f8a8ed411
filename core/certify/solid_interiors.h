// What rays inside transparent solids can meet before they leave them: known from the scene alone,
// without any cell.
#pragma once

#include <vector>

#include "core/trace/path_lists.h"
#include "core/tree/candidate_search.h"

namespace linetree {

class SolidInteriors {
 public:
  explicit SolidInteriors(const Tracer& tracer);

  // Of a solid that transmits and comes near no more than kMaxCandidates objects; else null.
  const SolidInterior* Find(int object) const {
    const SolidInterior& interior = interiors_[static_cast<size_t>(object)];
    return interior.candidates.empty() ? nullptr : &interior;
  }

 private:
  std::vector<SolidInterior> interiors_;  // by object
};

}  // namespace linetree
