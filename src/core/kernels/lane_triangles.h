#pragma once

#include "core/kernels/lane_vector.h"

// The triangles of a packet, eight at a time.
namespace organ_collision::core {
namespace {

template <class Real>
inline Real meanOf(const Lanes<Real>& lanes) {
  Real values[kLanes];
  lanes.store(values);
  for (int half = kLanes / 2; half > 0; half /= 2)
    for (int i = 0; i < half; ++i) values[i] += values[i + half];
  return values[0] / kLanes;
}

/// Eight triangles: a corner of each, and two edges from there.
template <class Real>
struct LaneTriangles {
  LaneVector<Real> a, ab, ac;

  Vector<Real> middle() const {
    const LaneVector<Real> middles = a + Lanes<Real>::all(Real{1} / 3) * (ab + ac);
    return {meanOf(middles.x), meanOf(middles.y), meanOf(middles.z)};
  }
  /// About; on the side of `direction`.
  Vector<Real> normalTowards(const Vector<Real>& direction) const {
    const LaneVector<Real> normals = cross(ab, ac);
    const Vector<Real> normal = {meanOf(normals.x), meanOf(normals.y), meanOf(normals.z)};
    return dot(normal, direction) < 0 ? Vector<Real>{} - normal : normal;
  }
  /// How far each reaches along a direction, and how near.
  Lanes<Real> farthestAlong(const LaneVector<Real>& direction) const {
    return dot(direction, a) +
           larger(larger(dot(direction, ab), dot(direction, ac)), Lanes<Real>{});
  }
  Lanes<Real> nearestAlong(const LaneVector<Real>& direction) const {
    return dot(direction, a) +
           smaller(smaller(dot(direction, ab), dot(direction, ac)), Lanes<Real>{});
  }
};

/// The same in their own frames.
template <class Real>
struct LaneFrames {
  LaneVector<Real> centroid, along, up;
  Lanes<Real> before, beyond, height;

  LaneVector<Real> normal() const { return cross(along, up); }
  /// Where the centroid is in the frame, from the foot.
  Lanes<Real> xOfCentroid() const { return third() * (beyond - before); }
  Lanes<Real> yOfCentroid() const { return third() * height; }
  LaneTriangles<Real> triangles() const {
    const LaneVector<Real> base = (before + beyond) * along;
    const LaneVector<Real> side = before * along + height * up;
    return {centroid - third() * (base + side), base, side};
  }

 private:
  static Lanes<Real> third() { return Lanes<Real>::all(Real{1} / 3); }
};
template <class Real>
inline LaneFrames<Real> framesOf(const TrianglePacket& packet) {
  return {load<Real>(packet.centroid),
          load<Real>(packet.along),
          load<Real>(packet.up),
          Lanes<Real>::load(packet.before.data()),
          Lanes<Real>::load(packet.beyond.data()),
          Lanes<Real>::load(packet.height.data())};
}
/// Relative to the packet's origin.
template <class Real>
inline LaneFrames<Real> framesFromOrigin(const TrianglePacket& packet) {
  LaneFrames<Real> frames = framesOf<Real>(packet);
  frames.centroid = frames.centroid - everywhere(vectorOf<Real>(packet.origin));
  return frames;
}
/// The same as triangles.
template <class Real>
inline LaneTriangles<Real> trianglesOf(const TrianglePacket& packet) {
  return framesFromOrigin<Real>(packet).triangles();
}

/// With unit vectors at right angles, as in single precision those that are kept are already.
inline LaneFrames<float> orthonormal(const LaneFrames<float>& frames) { return frames; }
inline LaneFrames<double> orthonormal(LaneFrames<double> frames) {
  const Lanes<double> one = Lanes<double>::all(1);
  frames.along = one / root(dot(frames.along, frames.along)) * frames.along;
  frames.up = frames.up - dot(frames.up, frames.along) * frames.along;
  frames.up = one / root(dot(frames.up, frames.up)) * frames.up;
  return frames;
}

}  // namespace
}  // namespace organ_collision::core
