// The trees are Embree's. Its boxes are single precision: seen from the middle of all boxes and in units of
// their extent, so that neither scale nor place matters, and rounded outwards. It works on one thread.
#include <embree3/rtcore.h>

#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "solvers/contact/box_pairs.h"

namespace springstab {
namespace {

constexpr int finds_between_builds = 32;

// To the next float beyond, which is further than what the double before it is wrong by.
float just_below(double x) {
  return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity());
}
float just_above(double x) {
  return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

/// Where the boxes are, and how large.
struct BoxFrame {
  Eigen::Array4d middle;
  double per_extent;

  explicit BoxFrame(std::span<const Box> boxes) {
    Box all = boxes[0];
    for (const Box& box : boxes) {
      all.low = all.low.min(box.low);
      all.high = all.high.max(box.high);
    }
    middle = all.low / 2 + all.high / 2;
    const double extent = (all.high - middle).maxCoeff();
    per_extent = extent > 0 ? 1 / extent : 1;
    if (!std::isfinite(extent) || !std::isfinite(per_extent) || !middle.allFinite())
      throw std::invalid_argument("boxes whose extent is " + std::to_string(extent) + ", expected it finite");
  }
};

void must_be_well(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE) throw std::runtime_error("Embree failed with error " + std::to_string(error));
}

}  // namespace

struct EmbreeRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
template <class Handle>
using EmbreeHandle = std::unique_ptr<std::remove_pointer_t<Handle>, EmbreeRelease>;

/// A tree over a number of boxes. Embree keeps where it is: it does not move.
class BoxTree {
 public:
  BoxTree(RTCDevice device, int count)
      : device_(device),
        bounds_(static_cast<std::size_t>(count)),
        scene_(rtcNewScene(device)),
        geometry_(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER)) {
    must_be_well(device);
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_LOW);  // else what is dynamic is built every time
    rtcSetGeometryUserPrimitiveCount(geometry_.get(), static_cast<unsigned>(count));
    rtcSetGeometryUserData(geometry_.get(), bounds_.data());
    rtcSetGeometryBoundsFunction(geometry_.get(), copy_bounds, nullptr);
    rtcAttachGeometry(scene_.get(), geometry_.get());
  }

  void move_to(std::span<const Box> boxes, const BoxFrame& frame) {
    for (std::size_t i = 0; i < bounds_.size(); ++i) {
      const Eigen::Array4d low = (boxes[i].low - frame.middle) * frame.per_extent,
                           high = (boxes[i].high - frame.middle) * frame.per_extent;
      bounds_[i] = {just_below(low[0]),  just_below(low[1]),  just_below(low[2]),  0,
                    just_above(high[0]), just_above(high[1]), just_above(high[2]), 0};
    }
    const bool anew = finds_++ % finds_between_builds == 0;
    rtcSetGeometryBuildQuality(geometry_.get(), anew ? RTC_BUILD_QUALITY_MEDIUM : RTC_BUILD_QUALITY_REFIT);
    rtcCommitGeometry(geometry_.get());
    rtcCommitScene(scene_.get());
    must_be_well(device_);
  }

  RTCScene scene() const { return scene_.get(); }

 private:
  static void copy_bounds(const RTCBoundsFunctionArguments* to) {
    *to->bounds_o = static_cast<const RTCBounds*>(to->geometryUserPtr)[to->primID];
  }

  RTCDevice device_;
  std::vector<RTCBounds> bounds_;
  EmbreeHandle<RTCScene> scene_;
  EmbreeHandle<RTCGeometry> geometry_;
  long finds_ = 0;
};

struct BoxPairs::Trees {
  EmbreeHandle<RTCDevice> device{rtcNewDevice("threads=1")};
  int first_count, second_count;
  BoxTree first;
  std::optional<BoxTree> second;
  std::vector<std::array<int, 2>> found;

  Trees(int of_first, int of_second)
      : first_count(of_first), second_count(of_second), first(device.get(), of_first) {
    if (of_second > 0) second.emplace(device.get(), of_second);
  }

  static void take_from_itself(void* found, RTCCollision* pairs, unsigned count) {
    for (unsigned k = 0; k < count; ++k)
      if (pairs[k].primID0 < pairs[k].primID1)
        static_cast<Trees*>(found)->found.push_back(
            {static_cast<int>(pairs[k].primID0), static_cast<int>(pairs[k].primID1)});
  }
  static void take(void* found, RTCCollision* pairs, unsigned count) {
    auto& trees = *static_cast<Trees*>(found);
    for (unsigned k = 0; k < count; ++k)
      trees.found.push_back(
          {static_cast<int>(pairs[k].primID0), trees.first_count + static_cast<int>(pairs[k].primID1)});
  }
};

bool has_embree() { return true; }

BoxPairs::BoxPairs(int first, int second) : trees_(std::make_unique<Trees>(first, second)) {}
BoxPairs::~BoxPairs() = default;

const std::vector<std::array<int, 2>>& BoxPairs::find(std::span<const Box> boxes) {
  Trees& t = *trees_;
  t.found.clear();
  if (boxes.empty()) return t.found;
  const BoxFrame frame(boxes);
  t.first.move_to(boxes.first(t.first_count), frame);
  if (t.second) {
    t.second->move_to(boxes.subspan(t.first_count), frame);
    rtcCollide(t.first.scene(), t.second->scene(), Trees::take, &t);
  } else {
    rtcCollide(t.first.scene(), t.first.scene(), Trees::take_from_itself, &t);
  }
  must_be_well(t.device.get());
  return t.found;
}

}  // namespace springstab
