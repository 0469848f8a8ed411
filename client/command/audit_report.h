// What `linetree bench audit` prints and writes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/audit/audit.h"

namespace linetree {

// A table with a line for every family or file and epsilon, sums, and a line for every violation
// that was kept.
std::string AuditText(const AuditReport& report);

// The same figures and violations; numbers of violations as hexadecimal floats, like in the text.
nlohmann::json AuditJson(const AuditReport& report, const AuditOptions& options);

}  // namespace linetree
