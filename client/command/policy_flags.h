// Which flights a corpus is made of.
#pragma once

#include <CLI/CLI.hpp>

#include "client/command/policy_corpus.h"

namespace linetree {

// --scene, --flight, --frames, the size, --epsilon, --seed and --threads; what is there already is
// the default.
void AddCorpusFlags(CLI::App& app, PolicyCorpus& corpus);

}  // namespace linetree
