#pragma once
#include <atomic>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "external_forces.h"
#include "palpate/device/device.h"
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

/// Energy balance at the end of the last period.
class LastBalance : public loop::Observer {
 public:
  bool wants_energy() const override { return true; }
  void energy(const loop::EnergyBalance& balance) override { balance_ = balance; }
  const loop::EnergyBalance& balance() const { return balance_; }

 private:
  loop::EnergyBalance balance_;
};

/// Optional parts of a simulation, for which others do not pay.
struct SimulationOptions {
  double duration_s = 0.0;                             ///< Simulated time [s]; 0: the scene's.
  std::vector<std::unique_ptr<device::Device>> hands;  ///< One per hand; null or missing: the scene's.
  bool external_forces = false;                        ///< Bodies take forces of the caller.
  bool energy = false;                                 ///< Computes the energy balance of each period.
};

/// Simulation of a scene, advanced period by period in virtual time.
class Simulation {
 public:
  /// Assembles the scene.
  Simulation(const scene::Description& description, SimulationOptions options);

  /// Advances by one period; returns false at the end.
  /// @throws StepFailure where the integrator has failed, now or before; Error where the run was stopped, or
  /// another call uses it
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
  /// Returns the energy balance at the end of the last period.  @throws Error if it was not requested
  const loop::EnergyBalance& energy() const;
  /// Returns the external forces of a body, by its index.  @throws Error if they were not requested
  ExternalForces& external_forces(std::size_t body);
  /// Tells the integrator that positions, velocities or forces have been changed. @pre leased
  void changed(dynamics::ReinitReason reason);

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
  std::optional<LastBalance> balance_;
  std::vector<std::shared_ptr<ExternalForces>> external_forces_;
  bool broken_ = false;  ///< A step ended by an exception.
  std::unique_ptr<loop::SteppedRun> run_;
  std::atomic<bool> stop_{false}, busy_{false};
  std::atomic<double> time_{0.0};
};

}  // namespace palpate::python
