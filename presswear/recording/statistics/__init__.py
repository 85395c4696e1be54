"""Statistics of cycles: means, wear maps and their 95 % intervals."""

from inspect import isfunction

from presswear.recording.statistics.bootstrap import (
    RESAMPLES,
    angle_interval,
    basic_interval,
    peak_of,
    pointwise_interval,
    resampled,
)
from presswear.recording.statistics.correlated_samples import (
    RANGE_STROKES,
    STARTUP_CYCLES,
    after_startup,
    differ,
    half_width,
    half_width_of_runs,
    inefficiency,
    mean_range,
    pooled,
    spread,
)
from presswear.recording.statistics.estimate import (
    LEVEL,
    MAX_FACTOR,
    MIN_SAMPLES,
    Estimate,
    about,
    quantile,
    ratio,
    widened,
)
from presswear.recording.statistics.wear_maps import (
    MAX_BATCHES,
    MIN_WIDTH,
    MapBatches,
    map_batches,
    map_errors,
    mean_map,
    smoothed,
    smoothed_maps,
    smoothed_mean,
    smoothing_widths,
)
from presswear.tools.arguments import takes_numbers

__all__ = [
    "LEVEL",
    "MAX_BATCHES",
    "MAX_FACTOR",
    "MIN_SAMPLES",
    "MIN_WIDTH",
    "RANGE_STROKES",
    "RESAMPLES",
    "STARTUP_CYCLES",
    "Estimate",
    "MapBatches",
    "about",
    "after_startup",
    "angle_interval",
    "basic_interval",
    "differ",
    "half_width",
    "half_width_of_runs",
    "inefficiency",
    "map_batches",
    "map_errors",
    "mean_map",
    "mean_range",
    "peak_of",
    "pointwise_interval",
    "pooled",
    "quantile",
    "ratio",
    "resampled",
    "smoothed",
    "smoothed_maps",
    "smoothed_mean",
    "smoothing_widths",
    "spread",
    "widened",
]

# Scripts call these functions, too.
for _name in __all__:
    if isfunction(_function := globals()[_name]):
        globals()[_name] = takes_numbers(_function)
