#pragma once
#include <functional>
#include <string>
#include <vector>

#include "palpate/study/exchange.h"
#include "palpate/study/trajectory.h"

namespace palpate::study {

/// One point of the work-precision chart.
struct ComparePoint {
  std::string integrator;
  std::string setting_name;        ///< "rtol" or "step_s"
  double setting = 0.0;
  TrajectoryError error;           ///< NaN throughout when the run failed
  std::vector<double> cpu_s;       ///< of each repeat
  double cpu_median_s = 0.0, cpu_min_s = 0.0, cpu_max_s = 0.0;
  loop::RunResult result;          ///< of the first repeat
  bool below_reference = false;    ///< its position error is not above the reference's own: not to be trusted
  bool force_below_reference = false, torque_below_reference = false;  ///< the same of the RMS on the hand
};

/// The truth that the points are held against, and how far it can be trusted.
struct Reference {
  std::string description;         ///< what it was made by, and what checked it
  TrajectoryError own_error;       ///< distance of two families at tight tolerance
  double cpu_s = 0.0;
};

/// One way of finding the tool's contact, against the first of the scene's list: how far the choice of method moves the result.
struct MethodPoint {
  std::string method;
  TrajectoryError difference;      ///< zero for the first
  double peak_force_n = 0.0;       ///< on the hand
  long most_samples = 0;           ///< contact samples at one time
  double query_s = 0.0, cpu_s = 0.0;
};

struct Comparison {
  std::string scene;
  Reference reference;
  std::vector<ComparePoint> points;
  std::vector<ExchangePoint> exchange;   ///< error of the exchange period itself; empty where the scene asks for none
  std::vector<MethodPoint> methods;      ///< empty where the scene names none
  bool stopped = false;
};

struct CompareOptions {
  int repeats = 3;
  std::vector<std::string> integrators;                             ///< empty: all of the scene's ladders
  std::function<void(double fraction, const std::string& what)> progress;
  const std::atomic<bool>* stop = nullptr;
};

/// Runs every ladder of the scene at its fixed exchange period against a tight reference; repeats are interleaved, so that a noisy machine hurts all alike.
Comparison compare(const scene::Description& description, const CompareOptions& options);

/// The scene with the tool's contact found by each method of `compare.contact_methods`, at the scene's own integrator settings.
std::vector<MethodPoint> compare_contact_methods(const scene::Description& description, const std::atomic<bool>* stop = nullptr);

/// compare.csv, exchange.csv, methods.csv and reference.json in `folder`: what report reads its tables, fitted orders and plots from.
void write(const Comparison& comparison, const std::string& folder);

}  // namespace palpate::study
