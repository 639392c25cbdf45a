// SPDX-License-Identifier: BSD-3-Clause
#include <exception>
#include <stdexcept>
#include <utility>

#include <dlfcn.h>

#include "datasets/bag/bag.h"
#include "datasets/bag/rosbag_module.h"
#include "datasets/files/bad_input.h"
#include "generated/rosbag_build.h"

namespace plumbline {
namespace {

constexpr const char* kModule = "plumbline_rosbag.so";

/// The functions of the module at `path` (as dlopen() takes it), which stays loaded; nullptr where
/// it is none of this build.
const internal::RosbagFunctions* functionsOf(const std::string& path) {
  void* const module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) return nullptr;
  const auto build = reinterpret_cast<const char* (*)()>(::dlsym(module, "plumbline_rosbag_build"));
  const void* const functions = ::dlsym(module, "plumbline_rosbag_functions");
  if (build != nullptr && functions != nullptr &&
      std::string_view(build()) == internal::kRosbagBuild) {
    return static_cast<const internal::RosbagFunctions*>(functions);
  }
  ::dlclose(module);
  return nullptr;
}

/// rosbag and what it needs would double the start of every command: its module is loaded with the
/// first bag. It lies where that of the plots does (report/plots/plots_on_demand.cpp).
const internal::RosbagFunctions* rosbag() {
  const std::string name = kModule;
  for (const std::string& path : {"$ORIGIN/" + name, "$ORIGIN/../lib/plumbline/" + name, name}) {
    if (const auto* found = functionsOf(path)) return found;
  }
  return nullptr;
}

template <class Work>
auto told(const std::string& path, const Work& work) {
  try {
    return work();
  } catch (const std::runtime_error& error) {
    throw badInput(
        path, {InputFault::kSyntax, "is no whole bag of ROS 1 (" + std::string(error.what()) + ")",
               "a recording that was closed", "try `rosbag reindex` on a copy"});
  }
}

class Ros1Bag : public Bag {
 public:
  Ros1Bag(std::string path, const internal::RosbagFunctions& rosbag)
      : path_(std::move(path)), rosbag_(rosbag) {}

  std::vector<BagTopic> topics() override {
    return told(path_, [&] { return rosbag_.topics(path_); });
  }

  void read(const std::vector<std::string>& topics,
            const std::function<void(const BagMessage&)>& take) override {
    std::exception_ptr refused;  // by who takes the messages: no fault of the bag
    told(path_, [&] {
      rosbag_.read(path_, topics, [&](std::string_view topic, std::string_view bytes) {
        try {
          take({topic, bytes, Serialization::kRos1});
        } catch (...) {
          refused = std::current_exception();
        }
        return refused == nullptr;
      });
    });
    if (refused) std::rethrow_exception(refused);
  }

 private:
  std::string path_;
  const internal::RosbagFunctions& rosbag_;
};

}  // namespace

std::unique_ptr<Bag> openRos1Bag(const std::string& path) {
  if (const auto* functions = rosbag()) return std::make_unique<Ros1Bag>(path, *functions);
  throw badInput(path, {InputFault::kUnsupported,
                        "is a bag of ROS 1, for which " + std::string(kModule) + " is missing", "",
                        "install librosbag-storage-dev (scripts/install_dependencies.sh bag), and "
                        "build and install again"});
}

}  // namespace plumbline
