// Where a figure comes from: without this nobody can repeat it.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace linetree {

struct Provenance {
  std::string command;  // a line for a shell
  std::string machine;  // processor, hardware threads, widest instruction set that is used
  std::string date;     // UTC, such as 2026-11-23 05:30
  std::string version;  // of this program

  // One line.
  std::string ToString() const;
};

// Of what this process does now. An empty command: the process's own command line.
Provenance ProvenanceOf(std::string command = "");
nlohmann::json ProvenanceJson(const Provenance& provenance);
// What ProvenanceJson has made; nothing for anything else.
std::optional<Provenance> ProvenanceFromJson(const nlohmann::json& json);

}  // namespace linetree
