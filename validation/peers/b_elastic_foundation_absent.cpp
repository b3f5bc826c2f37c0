#include "cases.h"

// In a build without Simbody the registry leaves this case out.
namespace palpate::validation {

ValidationCase elastic_foundation_peer() { return {}; }

}  // namespace palpate::validation
