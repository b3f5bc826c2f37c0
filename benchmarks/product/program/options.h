#pragma once
#include <string>
#include <vector>

#include "cli/program.h"

namespace palpate::cli {

struct BenchArguments {
  std::string what;  ///< "fem", "contact", "continuity" or "leave-out"
  /// of leave-out; empty: falling-ball and cantilever; of contact and continuity; empty: those of the paper
  std::vector<std::string> scenes;
  /// of contact; empty: "distance" and, where OpenGL opens, "image"; the first of continuity, else "distance"
  std::vector<std::string> methods;
  bool all = false;      ///< of contact: spreads of the stages
  bool growth = false;   ///< of contact: growth with skin and region instead
  bool check = false;    ///< of contact: compare what was measured with its bars
  int steps = 20;        ///< of fem
  int cells = 0;         ///< of fem, along one beam by way of a scene; 0: the sizes below
  double step_s = 0.01;  ///< of fem with cells
  std::vector<std::string> linear_solvers = {"auto"};
  std::vector<std::string> sizes;        ///< of fem; empty: S and M
  std::vector<int> threads;              ///< of fem and contact; empty: 1 and 2
  std::vector<double> linear_rtols;      ///< of fem; empty: 1e-6 and 1e-3
  std::vector<double> youngs_moduli_pa;  ///< of fem; empty: 1e5 and 1e6
  std::string folder;                    ///< of fem and contact: where JSON and plot go; empty: nowhere
  bool accuracy = false;                 ///< of fem: error against run time of one motion instead
  int repeats = 5;                       ///< of leave-out
  int paths = 1000;                      ///< of continuity
  int path_steps = 100;                  ///< of continuity
  double quadrature_error = 1e-3;        ///< of continuity
};
int bench(const BenchArguments& arguments);

/// Parses the line of `palpate bench`.
/// @throws Error for an invalid line
Invocation parse_bench(int argc, char** argv);

}  // namespace palpate::cli
