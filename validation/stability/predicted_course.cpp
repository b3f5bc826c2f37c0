#include "predicted_course.h"

#include <cmath>
#include <limits>

namespace palpate::stability {

PredictedCourse::PredictedCourse(const Column& column, const LinearProblem& problem, double H)
    : problem_(problem), modes_(problem.modes_at_start()) {
  for (Eigen::Index j = 0; j < problem.omega().size(); ++j) {
    steps_.emplace_back(column, problem.omega()[j] * H, problem.damping_ratio(j), problem.contact_share());
    x_.push_back(steps_.back().start(modes_.col(j)));
  }
}

void PredictedCourse::advance() {
  for (std::size_t j = 0; j < x_.size(); ++j) {
    x_[j] = (begun_ ? steps_[j].next() : steps_[j].first()) * x_[j];
    modes_.col(static_cast<Eigen::Index>(j)) = x_[j].head<2>();
  }
  begun_ = true;
  const double energy = problem_.energy(modes_);
  highest_ = std::isfinite(energy) ? std::max(highest_, energy) : std::numeric_limits<double>::infinity();
}

double PredictedCourse::spectral_radius() const {
  double largest = 0.0;
  for (const ModalSteps& mode : steps_) largest = std::max(largest, mode.spectral_radius());
  return largest;
}

}  // namespace palpate::stability
