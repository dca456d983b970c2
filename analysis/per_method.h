// What is computed of a method once, and kept as long as the program runs.
#pragma once

#include <map>
#include <mutex>

#include "analysis/method.h"

namespace springstab {

/// Kept by the method's identity, so that two methods of one name, or of one kind with other parameters, do
/// not share. Safe to use from any thread.
template <class T>
class PerMethod {
 public:
  /// compute() where it is not known yet; what is returned stays.
  template <class Compute>
  const T& of(const Method& method, const Compute& compute) {
    const std::lock_guard lock(mutex_);
    if (const auto known = all_.find(method); known != all_.end()) return known->second;
    return all_.emplace(method, compute()).first->second;
  }

 private:
  std::mutex mutex_;
  std::map<Method, T, Method::ByIdentity> all_;
};

}  // namespace springstab
