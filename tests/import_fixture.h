#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#ifndef SPOOR_DATA_DIR
#define SPOOR_DATA_DIR ""
#endif

namespace spoor {

/// A file of the third-party data; empty where it is not there.
inline std::string dataFile(const std::string& name) {
  const char* variable = std::getenv("SPOOR_DATA_DIR");
  const std::string path = std::string(variable ? variable : SPOOR_DATA_DIR) + "/" + name;
  return std::filesystem::exists(path) ? path : "";
}

#define SPOOR_NEEDS_DATA(variable, name)       \
  const std::string variable = dataFile(name); \
  if (variable.empty()) GTEST_SKIP() << "needs the data file " << name << " (SPOOR_DATA_DIR names their directory)"

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

inline bool anyContains(const std::vector<std::string>& notes, const std::string& part) {
  return std::any_of(notes.begin(), notes.end(), [&](const std::string& note) { return contains(note, part); });
}

/// Each test writes its files in a directory of its own.
class Import : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    directory_ = std::filesystem::path(::testing::TempDir()) / ("spoor_import_" + std::string(info->name()));
    std::filesystem::create_directories(directory_);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  std::string write(const std::string& name, const std::string& content) const {
    const std::string path = (directory_ / name).string();
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }

  std::filesystem::path directory_;
};

}  // namespace spoor
