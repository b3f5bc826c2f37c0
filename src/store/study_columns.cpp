#include "store/study_columns.h"

namespace palpate::store {

const std::vector<std::string>& compare_columns() {
  static const std::vector<std::string> columns = {"scene",
                                                   "label",
                                                   "integrator",
                                                   "family",
                                                   "order",
                                                   "stability",
                                                   "multistep",
                                                   "setting_name",
                                                   "setting",
                                                   "error_test_rtol",
                                                   "coarsest",
                                                   "linear_solver",
                                                   "against",
                                                   "position_error_rel_l2",
                                                   "position_error_max_m",
                                                   "force_error_rms_n",
                                                   "force_error_max_n",
                                                   "torque_error_rms_n_m",
                                                   "torque_error_max_n_m",
                                                   "energy_error_j",
                                                   "cpu_s_median",
                                                   "cpu_s_min",
                                                   "cpu_s_max",
                                                   "method_s",
                                                   "setup_s",
                                                   "record_s",
                                                   "repeats",
                                                   "force_evaluations",
                                                   "tangent_evaluations",
                                                   "factorisations",
                                                   "linear_solves",
                                                   "newton_iterations",
                                                   "contact_queries",
                                                   "steps",
                                                   "rejected_steps",
                                                   "reinitialisations",
                                                   "status",
                                                   "reason",
                                                   "unresolved",
                                                   "force_unresolved",
                                                   "torque_unresolved"};
  return columns;
}

const std::vector<std::string>& restart_columns() {
  static const std::vector<std::string> columns = {"scene",
                                                   "label",
                                                   "integrator",
                                                   "multistep",
                                                   "contact_refresh_s",
                                                   "simulated_s",
                                                   "reinitialisations",
                                                   "steps",
                                                   "force_evaluations",
                                                   "factorisations",
                                                   "cpu_s",
                                                   "status",
                                                   "reason"};
  return columns;
}

}  // namespace palpate::store
