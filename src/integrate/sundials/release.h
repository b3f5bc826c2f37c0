#pragma once
#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_mristep.h>
#include <cvode/cvode.h>
#include <fcntl.h>
#include <ida/ida.h>
#include <kinsol/kinsol.h>
#include <sundials/sundials_config.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_logger.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <limits>
#include <string>
#include <string_view>

#include "integrate/sundials/hidden.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"

// All differences between the tested releases of SUNDIALS: 6.4 (Debian 12) and 7.1 (Debian 13). All other
// files use names and meanings common to both.
#define PALPATE_SUNDIALS_7 (SUNDIALS_VERSION_MAJOR >= 7)

// 7.1 has one ARKodeSet.. for each ARKStepSet.. and MRIStepSet.., and marks the latter as deprecated; 6.4 has
// only the latter.
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

/// SUN_NLS_SUCCESS, SUNLS_SUCCESS and SUNMAT_SUCCESS of 6.x, replaced in 7.0 by SUN_SUCCESS.
constexpr int kSuccess = 0;

/// Calls ARKStepSetTableNum such that each step starts from f at its initial state.
///
/// 7.1 takes the last stage of a stiffly accurate table (b is the last row of A) for the solution, and f of
/// that stage for the first one of the next step, where that is explicit. The f of an implicit stage has the
/// error left by Newton's iteration, and neither includes a projection in between: the result of a step then
/// depends on whether the method was reset before it. 6.4 evaluates f again in each first stage.
/// 7.1 treats a table in the same way as 6.4 where b differs from the last row by more than 100 eps. Two
/// weights are shifted by 200 eps, in opposite directions, so that sum b = 1 is kept. The solution moves by
/// 200 eps h (f_s - f_(s-1)), less than 5e-14 of the change in a step: a twentieth of the tightest tolerance
/// (tuning.h).
/// @param memory  ARKStep's memory
/// @param implicit, explicit_  tables, or ARKODE_DIRK_NONE, ARKODE_ERK_NONE
/// @param projected  a step is post-processed
/// @return  the flag of the call
inline int set_tables(void* memory, ARKODE_DIRKTableID implicit, ARKODE_ERKTableID explicit_,
                      [[maybe_unused]] bool projected) {
#if PALPATE_SUNDIALS_7
  const bool by_newton = implicit != ARKODE_DIRK_NONE;
  // The explicit half of an additive pair is not stiffly accurate.
  const bool additive = by_newton && explicit_ != ARKODE_ERK_NONE;
  ARKodeButcherTable table = additive    ? nullptr
                             : by_newton ? ARKodeButcherTable_LoadDIRK(implicit)
                                         : ARKodeButcherTable_LoadERK(explicit_);
  if (table && ARKodeButcherTable_IsStifflyAccurate(table) &&
      (projected || (by_newton && table->A[0][0] == 0.0))) {
    constexpr double kShift = 200.0 * std::numeric_limits<double>::epsilon();
    table->b[table->stages - 1] += kShift;
    table->b[table->stages - 2] -= kShift;
    const int flag = ARKStepSetTables(memory, table->q, table->p, by_newton ? table : nullptr,
                                      by_newton ? nullptr : table);
    ARKodeButcherTable_Free(table);
    return flag;
  }
  ARKodeButcherTable_Free(table);
#endif
  return ARKStepSetTableNum(memory, implicit, explicit_);
}

/// Sets the right-hand side at the start of the current step in MRIStep's interpolant, which dense output and
/// root finding use. Must be called by the step's first evaluation of the slow side.
///
/// 7.0 and 7.1 evaluate the slow side there and take the memory for the sum of both sides as current,
/// although it is unset, or holds the value of the previous step (fixed in 7.2): a method of order 4
/// interpolates with it (findings/sundials-7.1-mristep-interpolates-unset-memory.sh). While it is not current
/// an interpolation evaluates it; requesting a derivative of a higher order than the interpolant has does
/// only that.
/// @param memory  MRIStep's memory
/// @param t  start of the step
/// @param scratch  receives the derivative, which is not used
inline void evaluate_start([[maybe_unused]] void* memory, [[maybe_unused]] double t,
                           [[maybe_unused]] N_Vector scratch) {
#if PALPATE_SUNDIALS_7 && SUNDIALS_VERSION_MAJOR == 7 && SUNDIALS_VERSION_MINOR < 2
  MRIStepGetDky(memory, t, ARK_INTERP_MAX_DEGREE + 1, scratch);
#endif
}

/// Solver whose errors are redirected.
enum class Solver { kCvode, kArkStep, kMriStep, kIda, kKinsol };

/// SUNContext without MPI. Errors of the attached solvers are passed to a handler, warnings to palpate's log
/// at the level `debug`; SUNDIALS prints nothing.
class Context {
 public:
  /// Handler of errors.
  /// @param function  the SUNDIALS function that reports the error
  /// @param text  the message
  /// @param data  argument of the constructor
  using ErrorHandler = void (*)(const char* function, const char* text, void* data);

  /// @throws InternalError where SUNDIALS creates no context
  Context(ErrorHandler handler, void* data) : handler_(handler), data_(data) {
    const int flag = SUNContext_Create(kNoCommunicator, &context_);
    PALPATE_CHECK(flag == 0, "SUNContext_Create returned flag {}", flag);
    prepare();
  }
  ~Context() {
    log_warnings();
    SUNContext_Free(&context_);
    if (warnings_ >= 0) ::close(warnings_);
  }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  operator SUNContext() const { return context_; }  // NOLINT: used in place of a SUNContext

#if PALPATE_SUNDIALS_7
  // With MPI a SUNComm is an MPI_Comm, which is a pointer in Open MPI: a null pointer compiles, but is not a
  // communicator, and MPI would terminate the process.
  static inline const SUNComm kNoCommunicator = SUN_COMM_NULL;

  /// Does nothing: solvers report to their context.
  void attach(Solver, void*) {}

  /// Writes the warnings so far to the log. Warnings are not passed to a handler: the logger writes them to a
  /// file of a given name, standard output by default. Here it is a file in memory. Must be called after
  /// calls that may warn.
  void log_warnings() {
    SUNLogger logger = nullptr;
    if (warnings_ < 0 || SUNContext_GetLogger(context_, &logger) != 0) return;
    SUNLogger_Flush(logger, SUN_LOGLEVEL_WARNING);
    std::array<char, 1024> text;
    for (ssize_t n = 0; (n = ::pread(warnings_, text.data(), text.size(), read_)) > 0; read_ += n)
      log::debug("SUNDIALS: {}", std::string_view(text.data(), static_cast<std::size_t>(n)));
  }

 private:
  void prepare() {
    // Handlers are a stack, all of which are called: the first one prints to standard error.
    SUNContext_ClearErrHandlers(context_);
    SUNContext_PushErrHandler(context_, on_error, this);
    SUNLogger logger = nullptr;
    if (SUNContext_GetLogger(context_, &logger) != 0 || !logger) return;
    warnings_ = ::memfd_create("sundials-warnings", MFD_CLOEXEC);
    const std::string name = "/proc/self/fd/" + std::to_string(warnings_);
    if (warnings_ >= 0 && SUNLogger_SetWarningFilename(logger, name.c_str()) == 0) return;
    SUNLogger_SetWarningFilename(logger, "/dev/null");  // Used where /proc is not mounted.
  }
  static void on_error(int, const char* function, const char*, const char* text, SUNErrCode code, void* data,
                       SUNContext) {
    auto* me = static_cast<Context*>(data);
    me->handler_(function, text ? text : SUNGetErrMsg(code), me->data_);
  }
#else
  static constexpr void* kNoCommunicator = nullptr;

  /// Sets the handler of a solver, for errors and warnings.
  void attach(Solver solver, void* memory) {
    int flag = 0;
    switch (solver) {
      case Solver::kCvode: flag = CVodeSetErrHandlerFn(memory, on_report, this); break;
      case Solver::kArkStep: flag = ARKStepSetErrHandlerFn(memory, on_report, this); break;
      case Solver::kMriStep: flag = MRIStepSetErrHandlerFn(memory, on_report, this); break;
      case Solver::kIda: flag = IDASetErrHandlerFn(memory, on_report, this); break;
      case Solver::kKinsol: flag = KINSetErrHandlerFn(memory, on_report, this); break;
    }
    PALPATE_CHECK(flag == 0, "SetErrHandlerFn returned flag {}", flag);
  }
  void log_warnings() {}

 private:
  void prepare() {}
  static void on_report(int code, const char*, const char* function, char* text, void* data) {
    auto* me = static_cast<Context*>(data);
    constexpr int kWarning = 99;  // CV_WARNING, ARK_WARNING, IDA_WARNING, KIN_WARNING
    if (code == kWarning)
      log::debug("SUNDIALS: {}: {}", function, text);
    else
      me->handler_(function, text, me->data_);
  }
#endif

  ErrorHandler handler_;
  void* data_;
  SUNContext context_ = nullptr;
  int warnings_ = -1;
  ::off_t read_ = 0;
};

}  // namespace sun
}  // namespace palpate::integrate
