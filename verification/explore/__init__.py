"""The live table: a local page on which a scene is picked, a ball is dragged, and what follows is seen.

An optional extra (`pinball-billiards[explore]`); nothing else imports it.
"""
