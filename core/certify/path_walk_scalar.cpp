// The path walk without SIMD: the plain twin.
#include "core/certify/path_certifier.h"
#include "core/certify/path_walk-inl.h"

namespace linetree {

CellPaths CertifyPathsScalar(const PathCertifier::Context& context,
                             const PathCertifier::Task& task) {
  return scalar_jets::CertifyPaths(context, task);
}

}  // namespace linetree
