#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/base/result.h"

namespace spoor {

/// The command line of every Spoor program: `--long-name=value` or `--long-name value`, and plain arguments.
/// --help prints the table with units and defaults. Parsing is getopt_long's.
class Options {
 public:
  Options(std::string program, std::string summary);

  /// Each adds an option that writes to `target`, whose present value is shown as the default.
  void add(std::string name, std::string unit, std::string help, std::string* target);
  void add(std::string name, std::string unit, std::string help, std::int64_t* target, std::int64_t lowest,
           std::int64_t highest);
  void add(std::string name, std::string unit, std::string help, double* target, double lowest, double highest);
  /// May be given several times; each adds a value.
  void add(std::string name, std::string unit, std::string help, std::vector<std::string>* target);
  void addFlag(std::string name, std::string help, bool* target);
  /// Plain arguments, in order; `count` is how many there may be at most.
  void addPlain(std::string name, std::string help, std::vector<std::string>* target, std::size_t count);

  /// Parses. Prints help and exits 0 on --help; prints one line and exits 2 on anything unknown or out of range.
  void parseOrExit(int argc, char** argv) const;

 private:
  struct Entry {
    std::string name, unit, help, default_text;
    bool takes_value = true;
    std::function<Status(const std::string&)> set;
  };
  std::string program_, summary_;
  std::vector<Entry> entries_;
  std::string plain_name_, plain_help_;
  std::vector<std::string>* plain_ = nullptr;
  std::size_t plain_count_ = 0;
};

}  // namespace spoor
