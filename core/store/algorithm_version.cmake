# Writes HEADER: a hash of the text of all sources in FOLDERS (below ROOT), by which cells that
# another program has kept are told apart.
string(REPLACE "," ";" FOLDERS ${FOLDERS})
set(texts "")
foreach(folder ${FOLDERS})
  file(GLOB sources ${ROOT}/${folder}/*.h ${ROOT}/${folder}/*.cpp)
  list(SORT sources)
  foreach(source ${sources})
    file(SHA256 ${source} hash)
    string(APPEND texts ${hash})
  endforeach()
endforeach()
string(SHA256 texts "${texts}")
string(SUBSTRING ${texts} 0 16 version)
file(CONFIGURE OUTPUT ${HEADER} CONTENT "// Made by algorithm_version.cmake.
#pragma once

#include <cstdint>

namespace linetree {

inline constexpr uint64_t kAlgorithmVersion = 0x${version};

}  // namespace linetree
")
