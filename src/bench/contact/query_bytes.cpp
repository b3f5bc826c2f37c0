#include "bench/contact/query_bytes.h"

namespace palpate::bench {

double query_bytes(const QueryCounts& counts) {
  return 48.0 * counts.nodes + 54.0 * counts.faces + 32.0 * counts.pixels + 264.0 * counts.samples;
}

}  // namespace palpate::bench
