#include "cases.h"

// Of a build without Simbody: the registry leaves the case out.
namespace palpate::validation {

ValidationCase elastic_foundation_peer() { return {}; }

}  // namespace palpate::validation
