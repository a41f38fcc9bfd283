"""`Surrogate` and `SeveritySurrogate`: Gaussian processes that predict where drives fail, and how severe they are.

Rasmussen and Williams 2006, "Gaussian Processes for Machine Learning", section 3.4 (classification by Laplace's
approximation). A latent function is positive where a drive fails. Its posterior at a point is a normal distribution,
so the probability that the point lies on the failing side is ``cdf(mean / deviation)``.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import ndtr
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessClassifier, GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
from threadpoolctl import ThreadpoolController

if TYPE_CHECKING:
    from numpy.typing import NDArray

LENGTH, LENGTHS = 0.3, (0.05, 5.0)  # of the unit cube: where the fit begins, and its limits
HEIGHT, HEIGHTS = 10.0, (1.0, 1e3)  # variance of the latent function, likewise
SHORT, SHORTS = 0.2, (0.05, 0.3)  # lengths of a fit that must keep every drive on its side
TALL, TALLS = 100.0, (30.0, 1e4)  # variance, likewise
FIRM, FIRM_LENGTHS = 1e4, (0.2, 0.1, 0.05)  # of fits without a search, where the likeliest still misplaces a drive
LEAST_DEVIATION = 1e-9
THREADS = ThreadpoolController()  # matrices are small, and the workers have the processors


OPTIMIZER = "fmin_l_bfgs_b"


def _kernel(
    dimensions: int, height: float, heights: tuple[float, float], length: float, lengths: tuple[float, float]
) -> ConstantKernel:
    """Return a squared-exponential kernel with a length for each dimension, and the limits of its fit."""
    return ConstantKernel(height, heights) * RBF(np.full(dimensions, length), lengths)


class Surrogate:
    """A fit to drives, some failed and some passed."""

    def __init__(
        self, points: NDArray[np.float64], failed: NDArray[np.bool_], kernel: ConstantKernel | None = None
    ) -> None:
        """Fit to points (N, D) of the unit cube; a given kernel stays as it is.

        Needs one failure and one success at least.
        """
        self._points, self._failed = points, failed
        if kernel is not None:
            self._model = self._fitted(kernel, None)
            return
        dimensions = points.shape[1]
        self._model = self._fitted(_kernel(dimensions, HEIGHT, HEIGHTS, LENGTH, LENGTHS), OPTIMIZER)
        if self._holds_all():
            return
        # the likeliest fit takes a few failures among many successes for noise; verdicts have none
        self._model = self._fitted(_kernel(dimensions, TALL, TALLS, SHORT, SHORTS), OPTIMIZER)
        for length in FIRM_LENGTHS:
            if self._holds_all():
                return
            self._model = self._fitted(_kernel(dimensions, FIRM, TALLS, length, SHORTS), None)

    def _holds_all(self) -> bool:
        """Whether every drive lies on the side of the boundary that its verdict says."""
        return bool(((self.latent(self._points)[0] > 0.0) == self._failed).all())

    def _fitted(self, kernel: ConstantKernel, optimizer: str | None) -> GaussianProcessClassifier:
        """Return a classifier fitted to the drives, with this kernel to begin from."""
        model = GaussianProcessClassifier(kernel, optimizer=optimizer)
        with THREADS.limit(limits=1), warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)  # at a limit: the limits are wide enough to draw by
            model.fit(self._points, self._failed)
        return model

    def latent(self, at: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(M,) mean and deviation of the latent function at points (M, D)."""
        with THREADS.limit(limits=1):
            mean, variance = self._model.latent_mean_and_variance(at)
        return mean, np.sqrt(np.maximum(variance, LEAST_DEVIATION**2))

    def failing(self, at: NDArray[np.float64]) -> NDArray[np.float64]:
        """(M,) the probability that points (M, D) lie on the failing side of the boundary."""
        mean, deviation = self.latent(at)
        side: NDArray[np.float64] = ndtr(mean / deviation)
        return side

    def believing(self, point: NDArray[np.float64]) -> Surrogate:
        """A fit that takes its own prediction at a point (D,) for a drive, with the same kernel.

        Ginsbourger, Le Riche, Carraro 2010, "Kriging is well-suited to parallelize optimization": the kriging believer.
        """
        mean, _ = self.latent(point[None, :])
        points, failed = np.vstack([self._points, point]), np.append(self._failed, mean[0] > 0.0)
        return Surrogate(points, failed, self._model.kernel_)

    def lengths(self) -> NDArray[np.float64]:
        """(D,) the length over which the latent function changes along each dimension, as a share of its range."""
        lengths: NDArray[np.float64] = np.atleast_1d(self._model.kernel_.k2.length_scale)
        return lengths


class SeveritySurrogate:
    """A fit to the severity of drives, for a search that has met no failure yet."""

    def __init__(self, points: NDArray[np.float64], severity: NDArray[np.float64]) -> None:
        """Fit to points (N, D) of the unit cube."""
        kernel = ConstantKernel(1.0, (1e-2, 1e2)) * RBF(np.full(points.shape[1], LENGTH), LENGTHS)
        self._model = GaussianProcessRegressor(kernel + WhiteKernel(1e-3, (1e-6, 1.0)), normalize_y=True)
        with THREADS.limit(limits=1), warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)
            self._model.fit(points, severity)

    def upper(self, at: NDArray[np.float64]) -> NDArray[np.float64]:
        """(M,) how severe a drive at points (M, D) may be: mean and two deviations (Cox and John 1992)."""
        with THREADS.limit(limits=1):
            mean, deviation = self._model.predict(at, return_std=True)
        bound: NDArray[np.float64] = mean + 2.0 * deviation
        return bound
