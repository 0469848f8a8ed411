// Where a program keeps what outlives it.
#pragma once

#include <string>

namespace linetree {

// The folder that the system gives a service ($STATE_DIRECTORY, of several the first), else
// $XDG_STATE_HOME/linetree, else $HOME/.local/state/linetree; empty where none of these is set.
std::string DefaultDataFolder();

// Of cells, in a data folder.
inline std::string CellFolder(const std::string& data_folder) { return data_folder + "/cells"; }

}  // namespace linetree
