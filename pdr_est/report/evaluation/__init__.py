"""The evaluation of a track from another program: its numbers as one document, and its page.

`document` makes `evaluation.json`, `page` the page, `plots` its errors over time, `explorable` what its scripts draw.
"""
