#include "core/store/data_folder.h"

#include <cstdlib>

namespace linetree {
namespace {

std::string Variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

std::string DefaultDataFolder() {
  const std::string given = Variable("STATE_DIRECTORY");
  if (!given.empty()) return given.substr(0, given.find(':'));
  const std::string state = Variable("XDG_STATE_HOME");
  if (!state.empty()) return state + "/linetree";
  const std::string home = Variable("HOME");
  return home.empty() ? "" : home + "/.local/state/linetree";
}

}  // namespace linetree
