#include "device/make.h"
#include "device/motions.h"
#include "palpate/device/profile.h"

namespace palpate::device {
namespace {

/// Device that follows its path, whatever wrench acts on it.
class ScriptDevice : public Device {
 public:
  explicit ScriptDevice(const DeviceSpec& spec)
      : path_(path_of(spec)), specification_(figures_of(spec).specification) {}
  DeviceSpecification specification() const override { return specification_; }
  std::function<HandleSample(double)> path() const override { return path_; }
  bool can_be_archived() const override { return true; }

 protected:
  HandleSample do_sample(double t) override { return path_(t); }

 private:
  DevicePath path_;
  DeviceSpecification specification_;
};

}  // namespace

std::unique_ptr<Device> make_script(const DeviceSpec& spec, const std::string&) {
  return std::make_unique<ScriptDevice>(spec);
}

}  // namespace palpate::device
