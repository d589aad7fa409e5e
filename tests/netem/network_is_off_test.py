"""Whether scripts/netem_matrix.py tells a network that is not the one asked for from chance."""
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from netem_matrix import BURST, LOSSES, network_is_off, probability_of_at_most


def row(loss, packets, packets_lost, measured_delay_ms=100.0):
    return {"loss": loss, "packets": packets, "packets_lost": packets_lost, "delay_ms": 100, "jitter_ms": 0.0,
            "reordering": 0.0, "wanted_delay_ms": 100.0, "measured_delay_ms": measured_delay_ms, "probes": 190}


class NetworkIsOff(unittest.TestCase):
    def test_chances_are_the_binomial_ones_where_losses_know_nothing_of_each_other(self):
        # 0.95^20, and 20 x 0.05 x 0.95^19 more.
        self.assertAlmostEqual(probability_of_at_most(0, 20, 0.05, 1 / 0.95), 0.3584859224, 9)
        self.assertAlmostEqual(probability_of_at_most(1, 20, 0.05, 1 / 0.95), 0.7358395249, 9)

    def test_bursts_begin_and_end_as_netems_do(self):
        enter, leave = 0.2 * 0.05 / 0.95, 0.2
        nobody = (1 - enter) ** 3
        one_of_three = 2 * (1 - enter) * enter * leave + (1 - enter) ** 2 * enter
        self.assertAlmostEqual(probability_of_at_most(0, 3, 0.05, BURST), nobody, 12)
        self.assertAlmostEqual(probability_of_at_most(1, 3, 0.05, BURST), nobody + one_of_three, 12)

    def test_a_few_long_bursts_are_chance(self):
        self.assertFalse(network_is_off(row("5b", 380, 85)))
        self.assertFalse(network_is_off(row("5b", 380, 0)))
        self.assertTrue(network_is_off(row("5b", 380, 130)))

    def test_losses_that_come_or_do_not(self):
        self.assertFalse(network_is_off(row("0", 1000, 0)))
        self.assertTrue(network_is_off(row("0", 1000, 1)))
        for loss in ("5", "20"):
            asked_for = round(1000 * LOSSES[loss])
            self.assertFalse(network_is_off(row(loss, 1000, asked_for)))
            self.assertTrue(network_is_off(row(loss, 1000, 0)))
            self.assertTrue(network_is_off(row(loss, 1000, 2 * asked_for)))

    def test_a_delay_that_is_not_the_one_asked_for(self):
        self.assertFalse(network_is_off(row("0", 1000, 0, measured_delay_ms=104.0)))
        self.assertTrue(network_is_off(row("0", 1000, 0, measured_delay_ms=106.0)))


if __name__ == "__main__":
    unittest.main()
