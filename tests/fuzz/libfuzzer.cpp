// libFuzzer entry point: `palpate_fuzzer --target=NAME [libFuzzer's options] CORPUS`. libFuzzer ignores
// options that begin with two dashes.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>

#include "fuzz/targets.h"

namespace {
const palpate::fuzz::Target* chosen = nullptr;
}

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr std::string_view kOption = "--target=";
  for (int i = 1; i < *argc; ++i)
    if (const std::string_view word = (*argv)[i]; word.starts_with(kOption)) try {
        chosen = &palpate::fuzz::target(word.substr(kOption.size()));
      } catch (const std::exception& e) { std::fprintf(stderr, "%s\n", e.what()); }
  if (!chosen) {
    std::fprintf(stderr, "palpate_fuzzer --target=NAME CORPUS; targets:\n");
    for (const palpate::fuzz::Target& one : palpate::fuzz::targets())
      std::fprintf(stderr, "  %-12s %s\n", one.name.c_str(), one.reads.c_str());
    std::exit(2);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  chosen->run({reinterpret_cast<const char*>(data), size});
  return 0;
}
