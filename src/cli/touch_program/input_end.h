#pragma once
#include <thread>

namespace palpate::cli {

/// Ends the program as SIGTERM does once the standard input ends: a parent that has died leaves no server
/// behind. What is written to the input is read and dropped.
class InputEnd {
 public:
  InputEnd();

 private:
  std::jthread watcher_;
};

}  // namespace palpate::cli
