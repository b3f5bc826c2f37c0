#include "cli/program.h"
#include "parse.h"

int main(int argc, char** argv) { return palpate::cli::run_program(argc, argv, palpate::cli::parse); }
