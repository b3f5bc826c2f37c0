#pragma once
#include <atomic>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "palpate/loop/stepped_run.h"

namespace palpate::python {

/// Failure of an integrator.
class StepFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Tick records per hand so far.  A full list is copied to one of twice the capacity; arrays that refer to
/// the old list keep it alive, so records never move while an array refers to them.
class TickLists : public loop::Observer {
 public:
  using List = std::shared_ptr<const std::vector<loop::TickRecord>>;
  explicit TickLists(std::size_t hands);
  void tick_of(std::size_t hand, const loop::TickRecord& tick) override;
  List of(std::size_t hand) const { return lists_[hand]; }
  std::size_t hands() const { return lists_.size(); }

 private:
  std::vector<std::shared_ptr<std::vector<loop::TickRecord>>> lists_;
};

/// Simulation of a scene, advanced period by period in virtual time.
class Simulation {
 public:
  /// Assembles the scene.  @param duration_s  simulated time [s]; 0: the scene's
  Simulation(const scene::Description& description, double duration_s);

  /// Advances by one period; returns false at the end.
  /// @throws StepFailure where the integrator has failed, now or before; Error where the run was stopped, or
  /// is in
  ///   use
  bool step();
  /// Advances by whole periods until `seconds` of simulated time have passed, or to the end.
  /// @throws Error for a time that is not positive, and as step()
  void advance(double seconds);
  /// Advances to the end.  @throws StepFailure, Error as step()
  void run();

  /// Flag that stops the run when set.
  std::atomic<bool>& stop() { return stop_; }
  /// Results so far.  @pre leased, where another thread may be stepping; the same holds for world() and
  /// ticks()
  const loop::RunResult& result() const { return run_->result(); }
  double time() const { return time_; }  ///< Simulated time so far [s]; may be called from any thread.
  bool finished() const;
  double duration() const { return run_->duration(); }
  loop::World& world() { return *world_; }
  const TickLists& ticks() const { return *ticks_; }

  /// Exclusive access to the World for one thread.  @throws Error where another thread has it
  class Lease {
   public:
    explicit Lease(Simulation& simulation);
    ~Lease() { busy_ = false; }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;

   private:
    std::atomic<bool>& busy_;
  };

 private:
  bool next();

  std::unique_ptr<loop::World> world_;
  std::unique_ptr<TickLists> ticks_;
  std::unique_ptr<loop::SteppedRun> run_;
  std::atomic<bool> stop_{false}, busy_{false};
  std::atomic<double> time_{0.0};
};

}  // namespace palpate::python
