// Every policy's maker, each in the file of its name. Private to the folder.
#pragma once

#include <memory>

#include "core/policy/eviction_policy.h"

namespace linetree {

std::unique_ptr<EvictionPolicy> MakeFifo();
std::unique_ptr<EvictionPolicy> MakeLru();
std::unique_ptr<EvictionPolicy> MakeClock();
std::unique_ptr<EvictionPolicy> MakeLfu();
std::unique_ptr<EvictionPolicy> MakeTwoQueue();
std::unique_ptr<EvictionPolicy> MakeArc();
std::unique_ptr<EvictionPolicy> MakeS3Fifo();
std::unique_ptr<EvictionPolicy> MakeSieve();
std::unique_ptr<EvictionPolicy> MakeWTinyLfu();
std::unique_ptr<EvictionPolicy> MakeGdsf();
std::unique_ptr<EvictionPolicy> MakeReuse();

}  // namespace linetree
