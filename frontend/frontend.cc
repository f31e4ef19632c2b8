#include "frontend/frontend.h"

#include <algorithm>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "common/geometry/so3.h"
#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/random.h"
#include "frontend/anchor_patch.h"
#include "frontend/feature_grid.h"
#include "frontend/gyro_rotation.h"
#include "frontend/klt_tracker.h"
#include "frontend/outlier_rejection.h"
#include "frontend/stereo_matcher.h"
#include "frontend/track_history.h"

namespace duet {
namespace {

/// A point that is being tracked in the first camera.
struct Track {
  std::uint64_t id = 0;
  cv::Point2f point;                    // raw px
  Eigen::Vector3d ray;                  // (x, y, 1)
  std::size_t patch = 0;                // index into the pool
  std::optional<double> inverse_depth;  // of the last stereo match, 1/m
};

Eigen::Vector2d ToVector(cv::Point2f point) { return {point.x, point.y}; }
cv::Point2f ToPoint(const Eigen::Vector2d& uv) {
  return {static_cast<float>(uv.x()), static_cast<float>(uv.y())};
}

}  // namespace

class Frontend::Impl {
 public:
  Impl(const FrontendOptions& options, int max_tracks, const RigCalibration& rig,
       std::uint64_t seed);

  void AddImu(const ImuSample& sample) { gyro_.Add(sample); }
  const TrackFrameSet& Process(Timestamp timestamp, std::span<const cv::Mat> images);

  FrontendStatistics statistics_;
  StageTimer* timer_ = nullptr;

 private:
  [[nodiscard]] const CameraCalibration& first() const { return rig_.cameras.front(); }

  void BuildPyramids(std::span<const cv::Mat> images);
  void PredictRotation(Timestamp timestamp);
  void FollowTracks();
  void CorrectByAnchors();
  void UpdateRays();
  void RejectOutliers(Timestamp timestamp);
  void RejectDrifters();
  void KeepApart();
  void DetectNew();
  void MatchStereo(std::size_t camera);
  void WriteFrames(Timestamp timestamp);

  /// Ends the tracks (and drops the entries of previous_ and history_entries_) that are not kept.
  void Keep(const std::vector<bool>& keep, int* lost);
  void ListEntries();

  FrontendOptions options_;
  RigCalibration rig_;
  KltTracker tracker_;
  FeatureGrid grid_;
  GyroRotation gyro_;
  Random random_;
  double focal_px_;
  std::vector<StereoMatcher> stereo_;  // camera 1, 2, ...
  cv::Ptr<cv::CLAHE> clahe_;

  std::optional<Timestamp> last_;
  std::uint64_t next_id_ = 0;
  std::vector<Track> tracks_;                  // ascending id: the oldest first
  std::vector<TrackHistory::Entry> previous_;  // the same tracks in the frame before
  TrackHistory history_;
  PatchShape patch_shape_;
  std::vector<AnchorPatch> patches_;  // pool, max_tracks of them
  std::vector<std::size_t> free_patches_;
  Eigen::Matrix3d R_C1C0_ = Eigen::Matrix3d::Identity();  // first camera, previous to newest frame
  bool rotation_known_ = false;
  std::vector<ImagePyramid> pyramids_;  // of the newest images, one a camera; empty: no image
  ImagePyramid previous_pyramid_;       // of the first camera
  std::vector<cv::Mat> equalized_;
  TrackFrameSet output_;
  // Scratch.
  std::vector<cv::Point2f> points_;
  std::vector<cv::Point2f> found_;
  std::vector<FlowStatus> status_;
  std::vector<bool> keep_;
  std::vector<bool> fits_;
  std::vector<RayPair> pairs_;
  std::vector<std::size_t> indices_;
  std::vector<TrackHistory::Entry> entries_;
  std::vector<StereoQuery> queries_;
  std::vector<std::optional<StereoMatch>> matches_;
};

Frontend::Impl::Impl(const FrontendOptions& options, int max_tracks, const RigCalibration& rig,
                     std::uint64_t seed)
    : options_(options),
      rig_(rig),
      tracker_(options),
      grid_(options, max_tracks,
            cv::Size(rig.cameras.at(0).model.width_px(), rig.cameras.at(0).model.height_px())),
      gyro_(rig.imu),
      random_(seed),
      focal_px_(0.5 *
                (rig.cameras[0].model.parameters()[0] + rig.cameras[0].model.parameters()[1])),
      history_(options.outlier_lag),
      patch_shape_(options.anchor_half_window_px),
      patches_(static_cast<std::size_t>(max_tracks)),
      pyramids_(rig.cameras.size()),
      equalized_(rig.cameras.size()) {
  for (std::size_t camera = 1; camera < rig.cameras.size(); ++camera) {
    stereo_.emplace_back(options, rig.cameras[0], rig.cameras[camera]);
  }
  if (options.fast_threshold_min > options.fast_threshold_max) {
    throw InputError("", 0, "frontend.fast_threshold_min", "must not exceed fast_threshold_max");
  }
  if (options.clahe) clahe_ = cv::createCLAHE(options.clahe_clip_limit);
  for (std::size_t i = 0; i < patches_.size(); ++i) free_patches_.push_back(i);
  cv::setNumThreads(options.threads);
}

const TrackFrameSet& Frontend::Impl::Process(Timestamp timestamp, std::span<const cv::Mat> images) {
  CHECK(!last_ || timestamp > *last_) << "frames out of order at " << timestamp;
  statistics_.frame = FrontendCounts{};
  BuildPyramids(images);
  if (last_) {
    PredictRotation(timestamp);
    FollowTracks();
    CorrectByAnchors();
    UpdateRays();
    RejectOutliers(timestamp);
    RejectDrifters();
    KeepApart();
  }
  statistics_.frame.kept = static_cast<int>(tracks_.size());
  DetectNew();
  ListEntries();
  history_.Push(R_C1C0_, entries_);
  WriteFrames(timestamp);
  for (std::size_t camera = 1; camera < rig_.cameras.size(); ++camera) MatchStereo(camera);
  last_ = timestamp;
  return output_;
}

void Frontend::Impl::BuildPyramids(std::span<const cv::Mat> images) {
  const StageTimer::Scope scope(timer_, "pyramid");
  CHECK_EQ(images.size(), rig_.cameras.size());
  CHECK(!images[0].empty()) << "the first camera's image is needed";
  std::swap(previous_pyramid_, pyramids_[0]);
  for (std::size_t camera = 0; camera < images.size(); ++camera) {
    const CameraModel& model = rig_.cameras[camera].model;
    if (images[camera].empty()) {
      pyramids_[camera].clear();
      continue;
    }
    CHECK_EQ(images[camera].type(), CV_8UC1);
    CHECK_EQ(images[camera].cols, model.width_px());
    CHECK_EQ(images[camera].rows, model.height_px());
    if (clahe_) {
      clahe_->apply(images[camera], equalized_[camera]);
    } else {
      equalized_[camera] = images[camera];
    }
    tracker_.BuildPyramid(equalized_[camera], &pyramids_[camera]);
  }
}

void Frontend::Impl::PredictRotation(Timestamp timestamp) {
  const Timestamp t_d = ToNanoseconds(rig_.t_d_s);
  const std::optional<Eigen::Quaterniond> R_B1B0 = gyro_.Between(*last_ + t_d, timestamp + t_d);
  rotation_known_ = R_B1B0.has_value();
  R_C1C0_.setIdentity();
  if (!rotation_known_) return;
  R_C1C0_ = (first().R_CB * *R_B1B0 * first().R_CB.conjugate()).toRotationMatrix();
}

void Frontend::Impl::FollowTracks() {
  const StageTimer::Scope scope(timer_, "klt");
  points_.clear();
  found_.clear();
  previous_.clear();
  for (const Track& track : tracks_) {
    points_.push_back(track.point);
    previous_.push_back({track.id, track.ray});
    Eigen::Vector2d guess = ToVector(track.point);
    if (options_.gyro_prediction) (void)first().model.Project(R_C1C0_ * track.ray, &guess);
    found_.push_back(ToPoint(guess));
  }
  tracker_.Track(previous_pyramid_, pyramids_[0], points_, options_.forward_backward_px, &found_,
                 &status_);
  keep_.assign(tracks_.size(), true);
  int lost = 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    tracks_[i].point = found_[i];
    keep_[i] = status_[i] == FlowStatus::kTracked;
    if (status_[i] == FlowStatus::kBackwardMismatch) ++statistics_.frame.lost_backward;
    if (status_[i] == FlowStatus::kNotFound) ++statistics_.frame.lost_flow;
  }
  Keep(keep_, &lost);
}

void Frontend::Impl::CorrectByAnchors() {
  const StageTimer::Scope scope(timer_, "anchor");
  if (!options_.anchor) return;
  const cv::Mat& image = LevelOf(pyramids_[0], 0);
  keep_.assign(tracks_.size(), true);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    Track& track = tracks_[i];
    AnchorPatch& patch = patches_[track.patch];
    const auto find = [&] {
      return patch.Find(patch_shape_, image, options_.anchor_max_shift_px,
                        options_.anchor_min_correlation, &track.point);
    };
    if (find() == AnchorPatch::Outcome::kFound) continue;
    // What served for a while has changed its looks (another distance or direction) and starts
    // again from the frame before; what never did is no point of the scene.
    Eigen::Vector2d last;
    keep_[i] = patch.age() >= options_.anchor_min_age &&
               first().model.Project(previous_[i].ray, &last) &&
               patch.Take(patch_shape_, LevelOf(previous_pyramid_, 0), ToPoint(last)) &&
               find() == AnchorPatch::Outcome::kFound;
  }
  Keep(keep_, &statistics_.frame.lost_anchor);
}

void Frontend::Impl::UpdateRays() {
  keep_.assign(tracks_.size(), true);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const Eigen::Vector2d uv = ToVector(tracks_[i].point);
    std::optional<Eigen::Vector3d> ray;
    if (first().model.Contains(uv, -options_.border_px)) ray = first().model.Unproject(uv);
    keep_[i] = ray.has_value();
    if (ray) tracks_[i].ray = *ray;
  }
  Keep(keep_, &statistics_.frame.lost_flow);
}

void Frontend::Impl::RejectOutliers(Timestamp timestamp) {
  const StageTimer::Scope scope(timer_, "outliers");
  if (!options_.outlier_rejection) return;
  pairs_.clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    pairs_.push_back({previous_[i].ray, tracks_[i].ray});
  }
  const EpipolarMotion motion = FindEpipolarMotion(pairs_, R_C1C0_,
                                                   {.iterations = options_.ransac_iterations,
                                                    .focal_px = focal_px_,
                                                    .threshold_px = options_.outlier_threshold_px},
                                                   &random_, &keep_);
  if (motion.valid && rotation_known_) {
    gyro_.LearnBias(first().R_CB.conjugate() * motion.delta, SecondsBetween(*last_, timestamp));
    statistics_.b_g = gyro_.b_g();
  }
  Keep(keep_, &statistics_.frame.lost_outlier);
}

void Frontend::Impl::RejectDrifters() {
  const StageTimer::Scope scope(timer_, "outliers");
  if (!options_.outlier_rejection) return;
  ListEntries();
  const Eigen::Matrix3d R = history_.PairWithOldest(R_C1C0_, entries_, &pairs_, &indices_);
  (void)FindEpipolarMotion(pairs_, R,
                           {.iterations = options_.ransac_iterations,
                            .focal_px = focal_px_,
                            .threshold_px = options_.outlier_lag_threshold_px},
                           &random_, &fits_);
  keep_.assign(tracks_.size(), true);
  for (std::size_t i = 0; i < indices_.size(); ++i) keep_[indices_[i]] = fits_[i];
  Keep(keep_, &statistics_.frame.lost_outlier);
}

void Frontend::Impl::KeepApart() {
  points_.clear();
  for (const Track& track : tracks_) points_.push_back(track.point);
  // Half the distance that new corners keep: tracks that move closer together live on.
  grid_.Mask(points_, 0.5 * options_.min_distance_px, &keep_);
  Keep(keep_, &statistics_.frame.lost_crowded);
}

void Frontend::Impl::Keep(const std::vector<bool>& keep, int* lost) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (keep[i]) {
      previous_[kept] = previous_[i];
      tracks_[kept++] = tracks_[i];
    } else {
      free_patches_.push_back(tracks_[i].patch);
    }
  }
  *lost += static_cast<int>(tracks_.size() - kept);
  tracks_.resize(kept);
  previous_.resize(kept);
}

void Frontend::Impl::ListEntries() {
  entries_.clear();
  for (const Track& track : tracks_) entries_.push_back({track.id, track.ray});
}

void Frontend::Impl::DetectNew() {
  const StageTimer::Scope scope(timer_, "detect");
  points_.clear();
  for (const Track& track : tracks_) points_.push_back(track.point);
  grid_.Detect(equalized_[0], points_, &found_);
  for (const cv::Point2f& corner : found_) {
    const std::optional<Eigen::Vector3d> ray = first().model.Unproject(ToVector(corner));
    if (!ray) continue;
    const std::size_t patch = free_patches_.back();
    free_patches_.pop_back();
    if (options_.anchor) patches_[patch].Take(patch_shape_, LevelOf(pyramids_[0], 0), corner);
    tracks_.push_back({next_id_++, corner, *ray, patch, std::nullopt});
    ++statistics_.frame.detected;
  }
}

void Frontend::Impl::WriteFrames(Timestamp timestamp) {
  output_.timestamp = timestamp;
  output_.frames.resize(rig_.cameras.size());
  for (std::size_t camera = 0; camera < output_.frames.size(); ++camera) {
    output_.frames[camera].timestamp = timestamp;
    output_.frames[camera].camera = static_cast<int>(camera);
    output_.frames[camera].observations.clear();
  }
  for (const Track& track : tracks_) {
    output_.frames[0].observations.push_back({track.id, track.point.x, track.point.y});
  }
  ++statistics_.frames;
  const FrontendCounts& frame = statistics_.frame;
  FrontendCounts& total = statistics_.total;
  total.kept += frame.kept;
  total.detected += frame.detected;
  total.lost_flow += frame.lost_flow;
  total.lost_backward += frame.lost_backward;
  total.lost_anchor += frame.lost_anchor;
  total.lost_outlier += frame.lost_outlier;
  total.lost_crowded += frame.lost_crowded;
}

void Frontend::Impl::MatchStereo(std::size_t camera) {
  const StageTimer::Scope scope(timer_, "stereo");
  if (pyramids_[camera].empty()) return;
  queries_.clear();
  for (const Track& track : tracks_) {
    queries_.push_back({track.point, track.ray, track.inverse_depth});
  }
  stereo_[camera - 1].Match(pyramids_[0], pyramids_[camera], queries_, &matches_);
  int matched = 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!matches_[i]) continue;
    ++matched;
    if (camera == 1) tracks_[i].inverse_depth = matches_[i]->inverse_depth;
    output_.frames[camera].observations.push_back(
        {tracks_[i].id, matches_[i]->point.x, matches_[i]->point.y});
  }
  const int unmatched = static_cast<int>(tracks_.size()) - matched;
  statistics_.frame.stereo_matched += matched;
  statistics_.total.stereo_matched += matched;
  statistics_.frame.stereo_unmatched += unmatched;
  statistics_.total.stereo_unmatched += unmatched;
}

Frontend::Frontend(const FrontendOptions& options, int max_tracks, const RigCalibration& rig,
                   std::uint64_t seed)
    : impl_(std::make_unique<Impl>(options, max_tracks, rig, seed)) {}
Frontend::~Frontend() = default;
void Frontend::AddImu(const ImuSample& sample) { impl_->AddImu(sample); }
const TrackFrameSet& Frontend::Process(Timestamp timestamp, std::span<const cv::Mat> images) {
  return impl_->Process(timestamp, images);
}
const FrontendStatistics& Frontend::statistics() const { return impl_->statistics_; }
void Frontend::set_stage_timer(StageTimer* timer) { impl_->timer_ = timer; }

}  // namespace duet
