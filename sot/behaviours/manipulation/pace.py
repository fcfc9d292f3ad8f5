"""How fast contacts are approached and loaded, and when the centre of mass has arrived.

Times are in √(leg / g), a quarter of a second for a robot of human size; lengths in leg lengths.
"""

CLOSING_SPEED = 0.0125  # leg lengths per √(leg/g): 3 cm/s
CLOSING_RAMP = 0.8  # √(leg/g)
CLOSING_PATIENCE = (
    2.0  # times as long as an approach takes, after which it is given up: what else is asked holds it off
)
TOUCH_LOAD = 3.5e-3  # weights: 2 N
LOAD_RAMP, HOLDING_TIME = 1.6, 1.6  # √(leg/g), of a contact that is made, and of one that is broken
COM_TIME = 3.2  # √(leg/g): the least time of a move of the centre of mass
COM_SPEED = 0.04  # leg lengths per √(leg/g), mean: longer moves take longer
COM_TOLERANCE = 0.02  # leg lengths from its goal, at which a support may be given up
COM_REST_SPEED = 0.01  # leg lengths per √(leg/g)
MAX_WAIT = 25.0  # √(leg/g), for the centre of mass
