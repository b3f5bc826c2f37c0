#include "cases.h"

// Without Simbody the registry omits this case.
namespace palpate::validation {

ValidationCase elastic_foundation_peer() { return {}; }

}  // namespace palpate::validation
