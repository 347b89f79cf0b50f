"""Training of the shipped gait models from folders of recordings.

* `gait_files`: recordings with known person and gait in a data folder. `gait_training`: from folder to model.
* `gait_card`: the model card in Markdown.
"""
