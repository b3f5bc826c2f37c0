#include "store/model_cache.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>

using namespace palpate;

namespace {

/// Sets an environment variable for the duration of a test.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    value ? ::setenv(name, value, 1) : ::unsetenv(name);
  }
  ~Variable() { old_ ? ::setenv(name_, old_->c_str(), 1) : ::unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> old_;
};

}  // namespace

TEST(ModelCache, APathOfTheCacheHasItsModelsName) {
  const Variable models("PALPATE_MODELS", "/somewhere/models");
  const std::string head = store::cached_model("head");
  EXPECT_EQ(std::filesystem::path(head).filename(), "head.h5");
  EXPECT_EQ(store::name_of_cached(head), "head");
  EXPECT_EQ(store::name_of_cached("/somewhere/models/head.h5"), "");  // another version's folder
  EXPECT_EQ(store::name_of_cached("head.h5"), "");
  EXPECT_EQ(store::name_of_cached(head + ".part"), "");
  EXPECT_EQ(store::name_of_cached(""), "");
}

TEST(ModelCache, WithoutAFolderForItNoPathIsOfIt) {
  const Variable models("PALPATE_MODELS", nullptr), cache("XDG_CACHE_HOME", nullptr), home("HOME", nullptr);
  EXPECT_EQ(store::name_of_cached("/home/me/.cache/palpate/0.1.0/head.h5"), "");
}
