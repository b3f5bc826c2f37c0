#pragma once
#include <optional>
#include <string>

#include "driver_guard.h"
#include "palpate/device/plugin.h"
#include "palpate/device/specification.h"

namespace palpate::device {

/// Shared object with a driver, whose table has been checked.
class PluginLibrary {
 public:
  /// Loads and checks the driver, and reads its specification.
  /// @param library, options  `library` and `library_options` of the scene  @param folder  the scene's
  /// @throws Error if there is no such file, it cannot be loaded, or its table does not fit this palpate
  PluginLibrary(const std::string& library, const std::string& options, const std::string& folder);
  ~PluginLibrary();
  PluginLibrary(const PluginLibrary&) = delete;
  PluginLibrary& operator=(const PluginLibrary&) = delete;

  const PalpatePlugin& table() const { return *table_; }
  const std::string& options() const { return options_; }
  const DeviceSpecification& specification() const { return specification_; }  ///< Stated figures.
  bool needs_real_time() const { return needs_real_time_; }                    ///< A person moves the device.
  bool has_velocities() const { return has_velocities_; }                      ///< Samples state velocities.
  bool has_motors() const { return table_->feedback; }

  /// Calls a function of the driver: `work` returns its error text, or null.
  /// @throws Error with that text, or that of a C++ exception
  template <class Work>
  void call(const char* function, const Work& work) const {
    std::string failure;
    try {
      const DriverCall call(name_, function);
      if (const char* const text = work()) failure = text;
    } catch (const std::exception& e) { failure = std::string("exception: ") + e.what(); }
    if (!failure.empty()) fail_in(function, failure);
  }

 private:
  void check_table(const std::string& library) const;
  void read_specification(const std::string& library);
  [[noreturn]] void fail_in(const char* function, const std::string& text) const;

  std::string options_;
  void* handle_ = nullptr;
  const PalpatePlugin* table_ = nullptr;
  DeviceSpecification specification_;
  bool needs_real_time_ = false, has_velocities_ = true;
  DriverName name_;
  std::optional<DriverGuard> guard_;
};

}  // namespace palpate::device
