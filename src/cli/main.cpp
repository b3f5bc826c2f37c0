#include "commands.h"
#include "palpate/cli/program.h"

int main(int argc, char** argv) { return palpate::cli::run_program(argc, argv, palpate::cli::parse); }
