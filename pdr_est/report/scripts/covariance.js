/** Turn 2-by-2 covariances into ellipses and radii. */
'use strict';

/** Quantile of the chi-squared distribution with 2 degrees of freedom, for regions that hold 95 %. */
const CHI2_95 = 5.991464547107979;

/** Compute the semi-axes, m, of the 95 % region and the angle of the longer one, rad; null if it is not finite. */
function ellipseAxes(cxx, cxy, cyy) {
  const middle = (cxx + cyy) / 2;
  const reach = Math.hypot((cxx - cyy) / 2, cxy);
  const long = Math.sqrt(CHI2_95 * Math.max(middle + reach, 0));
  const short = Math.sqrt(CHI2_95 * Math.max(middle - reach, 0));
  return Number.isFinite(long) && long > 0 ? { long, short, angle: Math.atan2(2 * cxy, cxx - cyy) / 2 } : null;
}

/** Compute the outline of a 95 % region as [y, x] pairs, m, in the order of Leaflet; empty if it is not finite. */
function ellipseOutline(x, y, cxx, cxy, cyy, corners = 48) {
  const axes = ellipseAxes(cxx, cxy, cyy);
  if (!axes) return [];
  const c = Math.cos(axes.angle);
  const s = Math.sin(axes.angle);
  return Array.from({ length: corners }, (_, i) => {
    const a = axes.long * Math.cos((2 * Math.PI * i) / corners);
    const b = axes.short * Math.sin((2 * Math.PI * i) / corners);
    return [y + s * a + c * b, x + c * a - s * b];
  });
}

/** Compute the outline of an ellipse {x_m, y_m, cxx_m2, cxy_m2, cyy_m2}, as `ellipseOutline`. */
function outlineOf({ x_m, y_m, cxx_m2, cxy_m2, cyy_m2 }) {
  return ellipseOutline(x_m, y_m, cxx_m2, cxy_m2, cyy_m2);
}

/** Compute the standard deviations along the longer and the shorter axis, m. */
function sigmas(cxx, cxy, cyy) {
  const axes = ellipseAxes(cxx, cxy, cyy);
  return axes ? [axes.long / Math.sqrt(CHI2_95), axes.short / Math.sqrt(CHI2_95)] : [NaN, NaN];
}
