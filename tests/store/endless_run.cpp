// Writes steps endlessly, with a line on standard output after each append() that has returned; run_kill_test
// kills it.
#include <cstdio>

#include "store/sample_run.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  palpate::store::RunFile file(argv[1], sample_run::parts(), sample_run::info(std::atoi(argv[2])));
  for (int step = 0;; ++step) {
    sample_run::append(file, step);
    std::printf("%d\n", step + 1);
    std::fflush(stdout);
  }
}
