#include "shared/base/options.h"

#include <getopt.h>

#include <charconv>
#include <cstdio>
#include <cstdlib>

#include "shared/base/assert.h"

namespace spoor {
namespace {

template <typename T>
std::string numberText(T value) {
  char digits[64];
  const auto end = std::to_chars(digits, digits + sizeof digits, value);
  return {digits, end.ptr};
}

template <typename T>
Status parseNumber(const std::string& text, T lowest, T highest, T* target) {
  T value{};
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc{} || end.ptr != text.data() + text.size()) return Error{"'" + text + "' is not a number"};
  if (!(value >= lowest && value <= highest))
    return Error{text + " is not within " + numberText(lowest) + " .. " + numberText(highest)};
  *target = value;
  return {};
}

}  // namespace

Options::Options(std::string program, std::string summary)
    : program_(std::move(program)), summary_(std::move(summary)) {}

void Options::add(std::string name, std::string unit, std::string help, std::string* target) {
  entries_.push_back({std::move(name), std::move(unit), std::move(help), *target, true, [target](const auto& text) {
                        *target = text;
                        return Status{};
                      }});
}

void Options::add(std::string name, std::string unit, std::string help, std::int64_t* target, std::int64_t lowest,
                  std::int64_t highest) {
  entries_.push_back({std::move(name), std::move(unit), std::move(help), numberText(*target), true,
                      [=](const auto& text) { return parseNumber(text, lowest, highest, target); }});
}

void Options::add(std::string name, std::string unit, std::string help, double* target, double lowest, double highest) {
  entries_.push_back({std::move(name), std::move(unit), std::move(help), numberText(*target), true,
                      [=](const auto& text) { return parseNumber(text, lowest, highest, target); }});
}

void Options::add(std::string name, std::string unit, std::string help, std::vector<std::string>* target) {
  entries_.push_back(
      {std::move(name), std::move(unit), std::move(help) + " (may be repeated)", "", true, [target](const auto& text) {
         target->push_back(text);
         return Status{};
       }});
}

void Options::addFlag(std::string name, std::string help, bool* target) {
  entries_.push_back({std::move(name), "", std::move(help), "", false, [target](const auto&) {
                        *target = true;
                        return Status{};
                      }});
}

void Options::addPlain(std::string name, std::string help, std::vector<std::string>* target, std::size_t count) {
  plain_name_ = std::move(name);
  plain_help_ = std::move(help);
  plain_ = target;
  plain_count_ = count;
}

void Options::parseOrExit(int argc, char** argv) const {
  const int help_code = int(entries_.size());
  std::vector<option> table;
  for (std::size_t i = 0; i < entries_.size(); ++i)
    table.push_back(
        {entries_[i].name.c_str(), entries_[i].takes_value ? required_argument : no_argument, nullptr, int(i)});
  table.push_back({"help", no_argument, nullptr, help_code});
  table.push_back({});
  const auto refuse = [&](const std::string& why) {
    std::fprintf(stderr, "%s: %s (see --help)\n", program_.c_str(), why.c_str());
    std::exit(2);
  };

  opterr = 0;
  optind = 0;
  for (;;) {
    const int code = getopt_long(argc, argv, ":", table.data(), nullptr);
    if (code == -1) break;
    if (code == '?') refuse(std::string("unknown option ") + argv[optind - 1]);
    if (code == ':') refuse(std::string(argv[optind - 1]) + " needs a value");
    if (code == help_code) {
      std::printf("%s: %s\n\n", program_.c_str(), summary_.c_str());
      if (plain_ != nullptr) std::printf("  %-28s %s\n", plain_name_.c_str(), plain_help_.c_str());
      for (const Entry& entry : entries_) {
        std::string left = "--" + entry.name + (entry.takes_value ? "=" + entry.unit : "");
        std::string right = entry.help + (entry.default_text.empty() ? "" : " [" + entry.default_text + "]");
        std::printf("  %-28s %s\n", left.c_str(), right.c_str());
      }
      std::exit(0);
    }
    const Entry& entry = entries_[std::size_t(code)];
    if (Status set = entry.set(optarg != nullptr ? optarg : ""); !set) refuse("--" + entry.name + ": " + set.error());
  }
  for (; optind < argc; ++optind) {
    if (plain_ == nullptr || plain_->size() >= plain_count_) refuse(std::string("unexpected argument ") + argv[optind]);
    plain_->push_back(argv[optind]);
  }
}

}  // namespace spoor
