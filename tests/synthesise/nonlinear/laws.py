"""Laws of the textbook plants."""

from collections.abc import Callable

from synth.plant import Plant
from synth.synthesise.nonlinear import dynamic_extension, feedback_linearisation
from synth.synthesise.nonlinear.feedback_linearisation import Linearisation
from tests import textbook_plants


def lawful(name: str) -> Linearisation:
    plants: dict[str, Callable[[], Plant]] = {
        "ball_and_beam": lambda: textbook_plants.ball_and_beam(0.1),
        "flexible_joint": textbook_plants.flexible_joint,
        "aircraft": lambda: textbook_plants.aircraft(0.3),
        "flat aircraft": lambda: dynamic_extension.extend(textbook_plants.aircraft(0.0)).plant,
        "unicycle": lambda: dynamic_extension.extend(textbook_plants.unicycle(0.2)).plant,
        "wheels": lambda: dynamic_extension.extend(textbook_plants.wheels()).plant,
    }
    return feedback_linearisation.of_plant(plants[name]())
