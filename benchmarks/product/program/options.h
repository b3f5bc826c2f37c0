#pragma once
#include <string>
#include <vector>

#include "cli/program.h"

namespace palpate::cli {

struct BenchArguments {
  std::string what;  ///< "fem", "contact", "continuity" or "leave-out".
  /// For leave-out; empty: falling-ball and cantilever. For contact and continuity; empty: the paper's
  /// scenes.
  std::vector<std::string> scenes;
  /// For contact; empty: "distance" and, where OpenGL opens, "image". For continuity the first, or else
  /// "distance".
  std::vector<std::string> methods;
  bool all = false;      ///< For contact: spreads of the stages.
  bool growth = false;   ///< For contact: growth with skin and region instead.
  bool check = false;    ///< For contact: compare the figures with their acceptance limits.
  int steps = 20;        ///< For fem.
  int cells = 0;         ///< For fem, along one beam defined as a scene; 0: the sizes below.
  double step_s = 0.01;  ///< For fem with cells.
  std::vector<std::string> linear_solvers = {"auto"};
  std::vector<std::string> sizes;        ///< For fem; empty: S and M.
  std::vector<int> threads;              ///< For fem and contact; empty: 1 and 2.
  std::vector<double> linear_rtols;      ///< For fem; empty: 1e-6 and 1e-3.
  std::vector<double> youngs_moduli_pa;  ///< For fem; empty: 1e5 and 1e6.
  std::string folder;                    ///< For fem and contact: folder for JSON and plot; empty: none.
  bool accuracy = false;                 ///< For fem: error against run time of one motion instead.
  int repeats = 5;                       ///< For leave-out.
  int paths = 1000;                      ///< For continuity.
  int path_steps = 100;                  ///< For continuity.
  double quadrature_error = 1e-3;        ///< For continuity.
};
int bench(const BenchArguments& arguments);

/// Parses the line of `palpate bench`.
/// @throws Error for an invalid line
Invocation parse_bench(int argc, char** argv);

}  // namespace palpate::cli
