#pragma once
#include <atomic>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "palpate/loop/stepped_run.h"

namespace palpate::python {

/// An integrator gave up.
class GaveUp : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The ticks of each hand so far.  A list that is full is copied to one twice as long, and whoever looks at
/// the old one keeps it: what was there when it was asked for stays where it is.
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

/// A scene that is being simulated, period by period, in virtual time.
class Simulation {
 public:
  /// @param duration_s  0: the scene's
  Simulation(const scene::Description& description, double duration_s);

  /// Goes through one period; false at the end.
  /// @throws GaveUp where the integrator did, now or before; Error where it was stopped, or is in use
  bool step();
  /// Goes on until `seconds` of simulated time have passed, or the end is reached: whole periods.
  /// @throws Error for a time that is not positive
  void advance(double seconds);
  void run();

  std::atomic<bool>& stop() { return stop_; }
  /// @pre leased, where another thread may be stepping; likewise for world() and ticks()
  const loop::RunResult& result() const { return run_->result(); }
  double time() const { return time_; }  ///< simulated so far [s]; any thread may ask
  bool finished() const;
  double duration() const { return run_->duration(); }
  loop::World& world() { return *world_; }
  const TickLists& ticks() const { return *ticks_; }

  /// The World is one thread's at a time.  @throws Error where another has it
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
