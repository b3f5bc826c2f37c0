#include "palpate/core/log.h"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include <algorithm>
#include <mutex>
#include <unordered_set>

#include "core/printable.h"

namespace palpate::log {
namespace {

/// Formats the message with control characters escaped.
class PrintableMessage : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
    const std::string text = printable({message.payload.data(), message.payload.size()});
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
    return std::make_unique<PrintableMessage>();
  }
};

/// Sink that stores the text of each distinct message once, up to kMostTexts; later ones are counted only,
/// each time they occur.
class Memory : public spdlog::sinks::base_sink<std::mutex> {
 public:
  std::vector<std::string> texts() {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> out = texts_;
    if (more_ > 0) out.push_back(fmt::format("{} more warnings, whose texts were not kept", more_));
    return out;
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    texts_.clear();
    known_.clear();
    more_ = 0;
  }

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    std::string text = printable({message.payload.data(), message.payload.size()});
    if (known_.contains(text)) return;
    if (texts_.size() == kMostTexts) {
      ++more_;
      return;
    }
    known_.insert(text);
    texts_.push_back(std::move(text));
  }
  void flush_() override {}

 private:
  static constexpr std::size_t kMostTexts = 1000;
  std::vector<std::string> texts_;
  std::unordered_set<std::string> known_;
  std::size_t more_ = 0;
};

std::shared_ptr<Memory>& memory() {
  static std::shared_ptr<Memory> one;
  return one;
}

}  // namespace

void configure(bool quiet, bool verbose) {
  const auto shown = quiet ? spdlog::level::err : verbose ? spdlog::level::debug : spdlog::level::info;
  static const auto terminal = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  terminal->set_level(shown);
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<PrintableMessage>('*').set_pattern("palpate: %^%l%$: %*");
  memory() = std::make_shared<Memory>();
  memory()->set_level(spdlog::level::warn);
  auto logger = std::make_shared<spdlog::logger>("palpate", spdlog::sinks_init_list{terminal, memory()});
  logger->set_formatter(std::move(formatter));
  logger->set_level(std::min(shown, spdlog::level::warn));
  spdlog::set_default_logger(logger);
}

std::vector<std::string> warnings() { return memory() ? memory()->texts() : std::vector<std::string>{}; }

void forget_warnings() {
  if (memory()) memory()->clear();
}

}  // namespace palpate::log
