import numpy as np
import pytest

from sim_plant.refine.spectra.onset_filter import onset_scores, peaks

RESPONSE = np.zeros((2, 400))
RESPONSE[0, 100:] = np.exp(-np.arange(300) / 40.0)
RESPONSE[1, 110:] = 0.5


def moved(response: np.ndarray, by: int) -> np.ndarray:
    """The same response ``by`` samples later."""
    found = np.zeros_like(response)
    found[:, by:] = response[:, : response.shape[1] - by]
    return found


@pytest.mark.parametrize("onset", [100, 157, 230])
def test_a_response_is_found_where_it_begins(onset: int) -> None:
    noise = np.random.default_rng(3).standard_normal((2, 400))
    white = noise + 3.0 * moved(RESPONSE, onset - 100)
    scores = onset_scores(white, RESPONSE, 100, 150)
    assert abs(int(np.argmax(scores)) - onset) <= 2


def test_without_noise_the_score_is_the_energy_that_a_fit_takes_out() -> None:
    """chi2 = (h.w)^2 / h.h = |w|^2 when w is a multiple of h."""
    white = 2.0 * RESPONSE[:, :]
    scores = onset_scores(white, RESPONSE, 100, 300)
    assert scores[100] == pytest.approx(float(np.sum(white**2)), rel=1e-9)


def test_of_noise_alone_the_score_is_chi_square_of_one_degree() -> None:
    rng = np.random.default_rng(5)
    scores = np.concatenate(
        [onset_scores(rng.standard_normal((2, 400)), RESPONSE, 100, 100)[:250] for _ in range(200)]
    )
    assert scores.mean() == pytest.approx(1.0, abs=0.1)


def test_peaks_are_apart() -> None:
    scores = np.array([0.0, 5.0, 6.0, 5.0, 0.0, 0.0, 4.0, 0.0])
    assert peaks(scores, 2, 3)[:2] == [2, 6]
