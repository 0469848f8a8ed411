// Lanes of a packet by the cells that they lie in, and what there is to do about a light there.
#if defined(LINETREE_CORE_FRAME_GROUPS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_FRAME_GROUPS_INL_H_
#undef LINETREE_CORE_FRAME_GROUPS_INL_H_
#else
#define LINETREE_CORE_FRAME_GROUPS_INL_H_
#endif

#include <algorithm>

#include "core/packet/packet.h"
#include "core/tree/light_certifier.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// Lanes that lie in one cell.
struct CellGroup {
  const CellLights* known = nullptr;
  LaneMask lanes = 0;
  LaneMask summed = 0;  // of these: kSummed lights are done but for their highlights
  // What is left of the tasks: those that are in no sum, and the others.
  const LightTask *next = nullptr, *end = nullptr;
  const LightTask *next_summed = nullptr, *end_summed = nullptr;

  // Of the task that comes next; `none`: there is none.
  HWY_INLINE size_t NextLight(size_t none) const {
    const size_t light = next != end ? next->light : none;
    return next_summed != end_summed ? std::min<size_t>(light, next_summed->light) : light;
  }
};

// What there is to do about one light.
struct LightWork {
  LaneMask on = 0, shines = 0, search = 0, listed_lanes = 0;
  int lists = 0;
  struct Listed {
    const CellGroup* group;
    const LightTask* task;
  };
  Listed listed[kPacketLanes];  // the first `lists`

  HWY_INLINE LightWork() {}
};

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
