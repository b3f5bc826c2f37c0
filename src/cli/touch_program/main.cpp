#include "cli/program.h"
#include "touch.h"

namespace {

using namespace palpate::cli;

Invocation parse(int argc, char** argv) {
  return parse_line(argc, argv,
                    {"palpate touch runs a scene in real time and shows it in a browser.", "", add_touch});
}

}  // namespace

int main(int argc, char** argv) { return run_program(argc, argv, parse); }
