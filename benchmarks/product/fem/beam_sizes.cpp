#include "palpate/core/error.h"
#include "product/fem.h"

namespace palpate::bench {

const std::vector<BeamSize>& beam_sizes() {
  static const std::vector<BeamSize> sizes = {
      {"XS", 16, 4}, {"S", 36, 9}, {"M", 56, 13}, {"L", 80, 19}, {"XL", 117, 28}};
  return sizes;
}

const BeamSize& size_named(const std::string& name) {
  for (const BeamSize& size : beam_sizes())
    if (size.name == name) return size;
  fail("bench fem: unknown size \"{}\"; use XS, S, M, L or XL", name);
}

}  // namespace palpate::bench
